# SPDX-License-Identifier: Apache-2.0
"""The routes of the live page: the page, its script and style, and a stream of what there is to show."""

from __future__ import annotations

import asyncio
import hmac
import threading
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass
from importlib import resources

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from slipwise.live.watch.history import History
from slipwise.live.watch.web_snapshot import snapshot
from slipwise.reporting.dark_colours import dark_style
from slipwise.reporting.page import drawing_script

PERIOD = 0.2  # s between two updates at the least
_ALIVE = 1.0  # s without news until the stream says that it is alive
_MOST_STREAMS = 16
_LOCAL_NAMES = frozenset({"127.0.0.1", "localhost", "[::1]"})
HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; img-src 'self' data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Cache-Control": "no-store",
}

Endpoint = Callable[[Request], Awaitable[Response]]


@dataclass(frozen=True)
class Access:
    """Who may read."""

    token: str | None  # to be in the query; None: it is not asked for
    local: bool  # only requests that name this machine: no site of others reaches it by a name of its own

    def refusal(self, request: Request) -> Response | None:
        """Return the answer to a request that is refused, None where it is not."""
        if self.local:
            name = request.headers.get("host", "").rpartition(":")[0] or request.headers.get("host", "")
            if name.lower() not in _LOCAL_NAMES:
                return _plain("this page is for the robot's own machine", 421)
        if self.token is not None:
            given = request.query_params.get("token", "").encode("utf-8", "replace")
            if not hmac.compare_digest(given, self.token.encode()):
                return _plain(
                    "the token is missing or wrong: open the address that `slipwise live` prints", 403
                )
        return None


class _Page:
    """What the routes answer."""

    def __init__(self, history: History, ending: threading.Event) -> None:
        self._history, self._ending = history, ending
        self._streams = 0
        self._made = (-1, 0.0, "")  # of which status, when, the message: one for all who look

    async def stream(self, _: Request) -> Response:
        if self._streams >= _MOST_STREAMS:
            return _plain("too many pages are open", 503)
        self._streams += 1  # before it is answered: many may ask at once
        headers = {**HEADERS, "X-Accel-Buffering": "no"}
        return _Stream(self._events(), self._stream_ended, headers)

    def _stream_ended(self) -> None:
        self._streams -= 1

    async def _events(self) -> AsyncIterator[str]:
        sent, said = "", 0.0
        while not self._ending.is_set():
            now = time.monotonic()
            news = self._news(now)
            if news != sent or now - said >= _ALIVE:
                yield f"event: state\ndata: {news}\n\n" if news != sent else "event: alive\ndata:\n\n"
                sent, said = news, now
            await asyncio.sleep(PERIOD)

    def _news(self, now: float) -> str:
        """Return the message; it is made again for a new status, and once a second for all else."""
        count, made, text = self._made
        if count != self._history.count or now - made >= _ALIVE:
            text = snapshot(self._history.seen())
            self._made = (self._history.count, now, text)
        return text


class _Stream(StreamingResponse):
    """Events, and what to do once they end, however they do."""

    def __init__(
        self, events: AsyncIterator[str], ended: Callable[[], None], headers: Mapping[str, str]
    ) -> None:
        super().__init__(events, media_type="text/event-stream", headers=headers)
        self._ended = ended

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._ended()


def application(history: History, access: Access, ending: threading.Event) -> Starlette:
    """Return the application; its streams end when `ending` is set."""
    page = _Page(history, ending)
    html = _asset("live.html").replace("?token", _query(access.token))
    style = (
        resources.files("slipwise.reporting").joinpath("report.css").read_text(encoding="utf-8")
        + dark_style()
        + _asset("live.css")
    )
    contents = {
        "/": (html, "text/html"),
        "/live.css": (style, "text/css"),
        "/live.js": (_asset("live.js"), "text/javascript"),
        "/plotly.js": (drawing_script(), "text/javascript"),
    }
    routes = {path: _fixed(text, kind) for path, (text, kind) in contents.items()}
    routes["/events"] = page.stream
    return Starlette(
        routes=[Route(path, _guarded(answer, access), methods=["GET"]) for path, answer in routes.items()]
    )


def _guarded(answer: Endpoint, access: Access) -> Endpoint:
    async def endpoint(request: Request) -> Response:
        return access.refusal(request) or await answer(request)

    return endpoint


def _fixed(text: str, kind: str) -> Endpoint:
    body = text.encode()

    async def endpoint(_: Request) -> Response:
        return Response(body, media_type=kind, headers=dict(HEADERS))

    return endpoint


def _query(token: str | None) -> str:
    """Return the query of the page's own files; a token is made of letters that need no escape."""
    return "" if token is None else f"?token={token}"


def _plain(text: str, status: int) -> Response:
    return Response(text, status_code=status, media_type="text/plain", headers=dict(HEADERS))


def _asset(name: str) -> str:
    return resources.files("slipwise.live.watch").joinpath("page", name).read_text(encoding="utf-8")

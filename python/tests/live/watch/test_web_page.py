# SPDX-License-Identifier: Apache-2.0
"""The live page is served read-only, to this machine or to who has the token, and streams what is new."""

from __future__ import annotations

import contextlib
import http.client
import json
import socket
import time
from collections.abc import Iterator
from typing import Any

import pytest
from live.sample_outputs import waiting_status

from slipwise.errors import OutputError
from slipwise.live.watch.web_page import WebPage, is_loopback

pytest.importorskip("uvicorn")
pytest.importorskip("starlette")


@pytest.fixture
def page() -> Iterator[WebPage]:
    opened = WebPage()
    yield opened
    opened.close()


@pytest.fixture
def open_page() -> Iterator[WebPage]:
    """Serve beyond this machine."""
    opened = WebPage(host="0.0.0.0")
    yield opened
    opened.close()


def _ask(page: WebPage, path: str, method: str = "GET", **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=10)
    connection.request(method, path, headers=headers)
    return connection.getresponse()


def _state(answer: http.client.HTTPResponse) -> dict[str, Any]:
    """Return the next state of a stream."""
    while True:
        line = answer.readline().decode().rstrip()
        if line == "event: state":
            return dict(json.loads(answer.readline().decode().removeprefix("data: ")))


def test_a_page_at_loopback_needs_no_token(page: WebPage) -> None:
    assert page.url == f"http://127.0.0.1:{page.port}/"
    assert page.token is None
    answer = _ask(page, "/")
    assert answer.status == 200
    assert b"<title>slipwise live</title>" in answer.read()


def test_every_answer_has_its_security_headers(page: WebPage, subtests: pytest.Subtests) -> None:
    for path in ["/", "/live.js", "/live.css", "/plotly.js", "/events"]:
        with subtests.test(path=path):
            headers = _ask(page, path).headers
            assert "default-src 'none'; script-src 'self';" in str(headers["Content-Security-Policy"])
            assert headers["X-Content-Type-Options"] == "nosniff"
            assert headers["Referrer-Policy"] == "no-referrer"
            assert headers["Access-Control-Allow-Origin"] is None
            assert headers["Cache-Control"] == "no-store"


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH"])
def test_nothing_can_be_written(page: WebPage, method: str) -> None:
    for path in ("/", "/events"):
        assert _ask(page, path, method).status == 405


def test_nothing_else_is_served(page: WebPage) -> None:
    for path in ("/../live.js", "/page/live.html", "/docs", "/openapi.json", "/live.js/"):
        assert _ask(page, path).status in (404, 307)


def test_the_stream_has_the_newest_status_and_each_new_one(page: WebPage) -> None:
    page.take(waiting_status(why="first"))
    answer = _ask(page, "/events")
    assert answer.headers["Content-Type"].startswith("text/event-stream")
    assert _state(answer)["status"]["why"] == "first"
    page.take(waiting_status(why="second"))
    assert _state(answer)["status"]["why"] == "second"


def test_the_stream_is_throttled(page: WebPage) -> None:
    answer = _ask(page, "/events")
    _state(answer)
    for i in range(500):
        page.take(waiting_status(segments=i))
    while _state(answer)["status"]["segments"] < 499:
        pass  # one or two states, not hundreds: the newest is among the next
    assert answer.status == 200


def test_a_site_that_gives_this_machine_a_name_of_its_own_is_refused(page: WebPage) -> None:
    for path in ("/", "/events", "/live.js"):
        assert _ask(page, path, Host="evil.example:80").status == 421
    assert _ask(page, "/", Host=f"localhost:{page.port}").status == 200


def test_beyond_this_machine_the_token_is_needed_for_everything(open_page: WebPage) -> None:
    assert open_page.token is not None
    assert len(open_page.token) >= 32
    assert open_page.url.endswith(f":{open_page.port}/?token={open_page.token}")
    for path in ("/", "/events", "/live.js", "/live.css", "/plotly.js"):
        for query in ("", "?token=", "?token=x", f"?token={open_page.token[:-1]}", "?token=%FF%00"):
            assert _ask(open_page, path + query).status == 403
        assert _ask(open_page, f"{path}?token={open_page.token}").status == 200
    html = _ask(open_page, f"/?token={open_page.token}").read().decode()
    assert f"live.js?token={open_page.token}" in html


def test_two_pages_have_different_tokens(open_page: WebPage) -> None:
    other = WebPage(host="0.0.0.0")
    other.close()
    assert other.token != open_page.token


def test_a_port_that_is_taken_is_said(page: WebPage) -> None:
    with pytest.raises(OutputError, match="cannot serve: Address already in use"):
        WebPage(port=page.port)
    with pytest.raises(OutputError, match="cannot serve"):
        WebPage(host="203.0.113.7")
    with pytest.raises(OutputError, match="cannot serve"):
        WebPage(port=99_999)


def test_closing_ends_open_streams_and_frees_the_port() -> None:
    page = WebPage()
    answer = _ask(page, "/events")
    _state(answer)
    page.close()
    page.close()
    answer.read()
    with socket.socket() as free:
        free.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        free.bind(("127.0.0.1", page.port))


def test_too_many_streams_are_refused_and_a_closed_one_makes_room(page: WebPage) -> None:
    streams = [_ask(page, "/events") for _ in range(16)]
    for stream in streams:
        _state(stream)
    assert _ask(page, "/events").status == 503
    streams[0].close()
    deadline = time.monotonic() + 20.0
    while _ask(page, "/events").status != 200:
        assert time.monotonic() < deadline
        time.sleep(0.1)


def test_loopback_is_told_from_other_addresses() -> None:
    assert [is_loopback(a) for a in ("127.0.0.1", "127.9.9.9", "::1", "::1%lo")] == [True] * 4
    assert [is_loopback(a) for a in ("0.0.0.0", "::", "192.168.1.4", "robot")] == [False] * 4


def test_half_requests_hold_few_files_and_not_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    from slipwise.live.watch import bounded_connections

    monkeypatch.setattr(bounded_connections, "ASKED_WITHIN", 1.0)
    page = WebPage()
    held = []
    try:
        for _ in range(300):
            half = socket.create_connection(("127.0.0.1", page.port), timeout=5)
            held.append(half)
            with contextlib.suppress(ConnectionError):  # one beyond the number may be closed by now
                half.sendall(b"GET / HTTP/1.1\r\nHost: 127.0")
        time.sleep(0.3)
        connections = page._server.server_state.connections
        assert len(connections) <= bounded_connections.MOST_CONNECTIONS
        until = time.monotonic() + 10.0
        while connections and time.monotonic() < until:
            time.sleep(0.05)
        assert _ask(page, "/").status == 200
    finally:
        for half in held:
            half.close()
        page.close()


def test_streams_are_counted_before_they_are_answered(page: WebPage) -> None:
    page.take(waiting_status())
    asked = []
    for _ in range(40):
        connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=10)
        connection.request("GET", "/events")
        asked.append(connection)
    answers = [connection.getresponse().status for connection in asked]
    assert answers.count(200) == 16
    assert answers.count(503) == 24
    for connection in asked:
        connection.close()
    until = time.monotonic() + 10.0
    while (status := _ask(page, "/events").status) == 503 and time.monotonic() < until:
        time.sleep(0.1)
    assert status == 200

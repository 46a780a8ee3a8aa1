# SPDX-License-Identifier: Apache-2.0
"""Serves the page of the live node: read-only, to this machine alone by default."""

from __future__ import annotations

import contextlib
import ipaddress
import secrets
import socket
import threading
import time
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from slipwise.errors import OutputError, SettingsError
from slipwise.extras import to_install
from slipwise.live.outputs import Output
from slipwise.live.watch.history import History
from slipwise.live.watch.watcher import Watcher

if TYPE_CHECKING:
    from uvicorn import Server

_START = 10.0  # s, until a server that does not start counts as broken
_TOKEN_BYTES = 24


class WebPage(Watcher):
    """The page, and the server behind it in a thread of its own.

    Beyond this machine a token is asked for; `url` has it in its query.
    """

    def __init__(self, *, host: str = "127.0.0.1", port: int = 0) -> None:
        """Begin to serve.

        Args:
            host: address to listen at; 0.0.0.0 is every one of this machine's.
            port: 0 takes a free one.

        Raises:
            SettingsError: Starlette or uvicorn is not installed.
            OutputError: the address cannot be used.
        """
        try:
            from uvicorn import Config, Server

            from slipwise.live.watch.bounded_connections import BoundedConnections
            from slipwise.live.watch.web_application import Access, application
        except ImportError as problem:
            raise SettingsError(
                f"the page needs a package that is missing: {problem.name}",
                advice=to_install("live"),
            ) from problem
        self._socket = _bound(host, port)
        self._history, self._ending = History(), threading.Event()
        local = is_loopback(self._socket.getsockname()[0])
        self.token = None if local else secrets.token_urlsafe(_TOKEN_BYTES)
        self.port = int(self._socket.getsockname()[1])
        self.url = _address(host, self.port, self.token)
        app = application(self._history, Access(self.token, local), self._ending)
        config = Config(
            app,
            http=BoundedConnections,
            log_config=None,
            access_log=False,
            server_header=False,
            lifespan="off",
        )
        config.timeout_graceful_shutdown = 1
        self._server: Server = Server(config)
        self._thread = threading.Thread(
            target=self._server.run, args=([self._socket],), name="slipwise-web", daemon=True
        )
        self._thread.start()
        self._wait_for_start()

    def take(self, output: Output) -> None:
        """Show an output."""
        self._history.take(output)

    def close(self) -> None:
        """Stop serving; pages that are open say that the connection is lost."""
        self._ending.set()
        self._server.should_exit = True
        self._thread.join(2.0)
        self._socket.close()

    def _wait_for_start(self) -> None:
        deadline = time.monotonic() + _START
        while not self._server.started:
            if not self._thread.is_alive() or time.monotonic() > deadline:
                self.close()
                raise OutputError("the page's server does not start", where=self.url)
            time.sleep(0.01)


def is_loopback(address: str) -> bool:
    """Whether an address is reached from this machine alone."""
    try:
        return ipaddress.ip_address(address.partition("%")[0]).is_loopback
    except ValueError:
        return False


def _bound(host: str, port: int) -> socket.socket:
    """Return a socket at the address.

    Raises:
        OutputError: another program has it, or it is not one of this machine's.
    """
    if not 0 <= port <= 65535:
        raise OutputError("cannot serve: no such port", where=str(port), advice="choose one up to 65535")
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        bound = socket.socket(family, kind, protocol)
    except OSError as problem:
        raise OutputError(f"cannot serve: {problem}", where=f"{host}:{port}") from problem
    try:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
    except OSError as problem:
        bound.close()
        advice = "choose another port or host"
        raise OutputError(
            f"cannot serve: {problem.strerror}", where=f"{host}:{port}", advice=advice
        ) from problem
    return bound


def _reached_address(version: int) -> str:
    """Return this machine's address in its network, or its name where it is in none; nothing is sent."""
    family, elsewhere = (socket.AF_INET6, "2001:db8::1") if version == 6 else (socket.AF_INET, "192.0.2.1")
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((elsewhere, 9))  # an address for documents, without a host
            return str(probe.getsockname()[0])
    except OSError:
        return socket.gethostname()


def _address(host: str, port: int, token: str | None) -> str:
    """Return the address to open; of a server at every address, one that others reach."""
    with contextlib.suppress(ValueError):
        if (address := ipaddress.ip_address(host)).is_unspecified:
            host = _reached_address(address.version)
    name = f"[{host}]" if ":" in host else host
    query = f"?{urlencode({'token': token})}" if token else ""
    return f"http://{name}:{port}/{query}"

# SPDX-License-Identifier: Apache-2.0
"""A real HTTP server on this machine, whose files are bytes in memory."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


@dataclass
class Server:
    """Files by their path, and what was asked for."""

    address: str
    files: dict[str, bytes] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    silent: bool = False  # about how long a file is
    cut: bool = False  # before the end
    pause: float = 0.0  # s between two bytes
    sent: int = 0  # bytes, with pauses
    headers: dict[str, str] = field(default_factory=dict)  # beside the length


@contextlib.contextmanager
def serving() -> Iterator[Server]:
    """Serve what is put into `files` until the end."""

    class Handler(BaseHTTPRequestHandler):
        def do_HEAD(self) -> None:
            self._answer(body=False)

        def do_GET(self) -> None:
            self._answer(body=True)

        def _answer(self, *, body: bool) -> None:
            content = shared.files.get(self.path.partition("?")[0])
            if body:
                shared.asked.append(self.path)
            if content is None:
                self.send_error(403 if "locked" in self.path else 404)
                return
            self.send_response(200)
            if not shared.silent:
                self.send_header("Content-Length", str(len(content)))
            for name, value in shared.headers.items():
                self.send_header(name, value)
            self.end_headers()
            if body and shared.pause:
                with contextlib.suppress(OSError):  # nobody waits any more
                    for byte in content:
                        self.wfile.write(bytes([byte]))
                        self.wfile.flush()
                        shared.sent += 1
                        time.sleep(shared.pause)
            elif body:
                self.wfile.write(content[: len(content) // 2] if shared.cut else content)

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    shared = Server(f"http://127.0.0.1:{http.server_port}")
    thread = threading.Thread(target=http.serve_forever, daemon=True)
    thread.start()
    try:
        yield shared
    finally:
        http.shutdown()
        http.server_close()
        thread.join()

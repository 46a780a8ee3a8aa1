# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium without network, driven over a pipe (Chrome DevTools protocol)."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Any

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--blink-settings=primaryHoverType=2,availableHoverTypes=2",  # a mouse: figures have their buttons
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
    "--remote-debugging-pipe",
)
# The browser reads commands from descriptor 3 and answers on 4.
START = (
    "import fcntl, os, sys; r, w = (fcntl.fcntl(int(f), fcntl.F_DUPFD, 10) for f in sys.argv[1:3]); "
    "os.dup2(r, 3); os.dup2(w, 4); os.execv(sys.argv[3], sys.argv[3:])"
)
SCREEN_HEIGHT = 900  # px of the window
SCREENSHOT_HEIGHT = (
    1600  # px of one picture; a browser without graphics card repeats itself in very high ones
)
PATIENCE = 120.0  # s until a page that does not answer counts as broken


def find_browser() -> str | None:
    """Return the path of a Chromium, None where there is none."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


class Browser:
    """One page of a headless browser; used as a context manager."""

    def __init__(self, program: str, profile: Path) -> None:
        self.requests: list[str] = []
        self.problems: list[str] = []
        self._profile, self._program = profile, program
        self._buffer = b""
        self._count = 0
        self._session = ""

    def __enter__(self) -> Browser:
        commands, self._write = os.pipe()
        self._read, answers = os.pipe()
        self._process = subprocess.Popen(
            [
                *(sys.executable, "-c", START, str(commands), str(answers), self._program),
                *FLAGS,
                f"--user-data-dir={self._profile}",
            ],
            pass_fds=(commands, answers),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(commands)
        os.close(answers)
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.connect(False)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.terminate()
        try:
            self._process.wait(20)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._write)
        os.close(self._read)

    def connect(self, connected: bool) -> None:
        """Let pages reach servers of this machine, or none at all, as at the beginning."""
        speed = -1 if connected else 0  # bytes/s; -1 is without limit
        limits = {"latency": 0, "downloadThroughput": speed, "uploadThroughput": speed}
        self.call("Network.emulateNetworkConditions", offline=not connected, **limits)

    def prefer(self, scheme: str) -> None:
        """Ask pages for "light" or "dark" colours."""
        feature = {"name": "prefers-color-scheme", "value": scheme}
        self.call("Emulation.setEmulatedMedia", features=[feature])

    def wait_for(self, expression: str) -> None:
        """Wait until a JavaScript expression is true."""
        deadline = time.monotonic() + PATIENCE
        while not self.value(expression):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{expression} stays false")
            time.sleep(0.05)

    def open(self, page: Path, *, width: int) -> None:
        """Show a file at a width [px] and wait until its script says that it is ready."""
        self.go(page.resolve().as_uri(), width=width)
        deadline = time.monotonic() + PATIENCE
        while self.value("document.documentElement?.dataset.ready") != "yes":
            if time.monotonic() > deadline:
                raise TimeoutError(
                    f"{page} is not ready: {self.value('document.documentElement.dataset.errors')}"
                )
            time.sleep(0.05)

    def go(self, address: str, *, width: int) -> None:
        """Show what is at an address, at a width [px]."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=SCREEN_HEIGHT,
            deviceScaleFactor=1,
            mobile=width < 600,
        )
        self.requests.clear()
        self.problems.clear()
        self.call("Page.navigate", url=address)

    def value(self, expression: str) -> Any:
        """Return what a JavaScript expression evaluates to."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def screenshots(self, folder: Path, name: str) -> list[Path]:
        """Write PNGs of the whole page, one below the other, and return their paths."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        paths = []
        for part, top in enumerate(range(0, int(size["height"]), SCREENSHOT_HEIGHT)):
            height = min(SCREENSHOT_HEIGHT, size["height"] - top)
            clip = {"x": 0, "y": top, "width": size["width"], "height": height, "scale": 1}
            data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)[
                "data"
            ]
            paths.append(folder / f"{name}.{part:02d}.png")
            paths[-1].write_bytes(base64.b64decode(data))
        return paths

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send one command and return its result, noting the events that come before it."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == self._count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return dict(answer["result"])
            self._note(answer)

    def _note(self, event: dict[str, Any]) -> None:
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(str(parameters["request"]["url"]))
        elif method == "Runtime.exceptionThrown":
            self.problems.append(json.dumps(parameters["exceptionDetails"])[:500])
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.problems.append(str(parameters["entry"]["text"]))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] == "error":
            self.problems.append(json.dumps(parameters["args"])[:500])

    def _receive(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._read], [], [], PATIENCE)[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self._read, 1 << 16)
            if not part:
                raise RuntimeError("the browser ended")
            self._buffer += part
        line, self._buffer = self._buffer.split(b"\0", 1)
        return dict(json.loads(line))

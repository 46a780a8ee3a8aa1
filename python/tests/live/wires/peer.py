# SPDX-License-Identifier: Apache-2.0
"""Starts a peer of the wires in another process and another Python, and asks it by lines of JSON."""

from __future__ import annotations

import json
import os
import subprocess
import threading
from pathlib import Path
from types import TracebackType
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[3]

#: Far below the ports that the system hands out, and another one for each process of tests.
DOMAIN = 1 + os.getpid() % 100


class Peer:
    """A script that prints "ready", then one line of JSON for each that it is asked.

    Args:
        python: that runs it.
        script: its name in this folder.
        arguments: of the script.
        environment: what it is told besides the domain.
        patience: after which a peer that does not answer is ended [s].
    """

    def __init__(
        self, python: Path, script: str, *arguments: str, environment: dict[str, str], patience: float = 60.0
    ) -> None:
        self._patience = patience
        kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "CYCLONE"))}
        told = {
            "ROS_DOMAIN_ID": str(DOMAIN),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "PYTHONUNBUFFERED": "1",
            "CYDR_CACHE_DIR": str(python.parents[1] / "compiled"),  # of pyzeros; `make ros-peer` fills it
            **environment,
        }
        self._process = subprocess.Popen(
            [str(python), str(HERE / script), *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**kept, **told},
        )
        ready = self.hear()
        assert ready == "ready"

    def hear(self) -> Any:
        """Return the next line; fails where the peer has ended."""
        assert self._process.stdout is not None
        watchdog = threading.Timer(self._patience, self._process.kill)
        watchdog.start()
        line = self._process.stdout.readline()
        watchdog.cancel()
        assert line, f"the peer has ended with code {self._process.wait()}"
        return json.loads(line)

    def tell(self, do: str, **what: object) -> None:
        """Ask without waiting."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": do, **what}) + "\n")
        self._process.stdin.flush()

    def ask(self, do: str, **what: object) -> Any:
        """Ask and return the answer."""
        self.tell(do, **what)
        return self.hear()

    def close(self) -> None:
        """Let it end; may be called twice."""
        if self._process.poll() is None:
            try:
                self.tell("quit")
                self._process.wait(5.0)
            except (OSError, subprocess.TimeoutExpired):
                self._process.kill()
                self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()

    def kill(self) -> None:
        """End it as a power cut would."""
        self._process.kill()
        self._process.wait()

    def __enter__(self) -> Peer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

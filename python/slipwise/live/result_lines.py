# SPDX-License-Identifier: Apache-2.0
"""Results as JSON lines into a file or a pipe; what cannot be written is counted, and the node goes on."""

from __future__ import annotations

import os
import threading
from typing import Protocol


class Writable(Protocol):
    """An unbuffered binary stream: what it has taken is written."""

    def write(self, data: bytes, /) -> int | None:
        """Write some of the bytes; return how many."""


class ResultLines:
    """Writes lines whole; one that was cut off by a full disk is ended before the next."""

    def __init__(self, stream: Writable) -> None:
        self._stream, self._lost, self._cut, self._standing = stream, 0, False, ""
        self._lock = threading.Lock()
        self._gone = False
        self._new: list[str] = []

    def write(self, line: str) -> None:
        """Write a line; whoever read it may be gone."""
        if self._gone:
            return
        data = line.encode("utf-8", "backslashreplace") + b"\n"
        data = b"\n" + data if self._cut else data
        left = len(data)
        try:
            while left:
                left -= self._stream.write(data[len(data) - left :]) or 0
        except BrokenPipeError:
            self._gone = True
        except (OSError, ValueError) as problem:
            self._cut = self._cut or left < len(data)
            self._lose(problem)
        else:
            self._cut = False
            self._recover()

    def notices(self) -> list[str]:
        """Return what is to be said since the last call."""
        with self._lock:
            new, self._new = self._new, []
        return new

    def close(self) -> None:
        """Say how many were lost."""
        self._recover()

    def _lose(self, problem: OSError | ValueError) -> None:
        reason = (
            os.strerror(problem.errno) if isinstance(problem, OSError) and problem.errno else str(problem)
        )
        self._lost += 1
        if reason != self._standing:
            self._standing = reason
            self._say(f"results cannot be written: {reason}")

    def _recover(self) -> None:
        if self._lost:
            self._say(f"{self._lost} results were lost: {self._standing}")
        self._lost, self._standing = 0, ""

    def _say(self, text: str) -> None:
        with self._lock:
            self._new.append(text)

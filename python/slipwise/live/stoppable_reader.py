# SPDX-License-Identifier: Apache-2.0
"""A stream whose reader can be stopped while it waits for more."""

from __future__ import annotations

import io
import os
import select
from typing import Any


class StoppableReader(io.BufferedReader):
    """Reads a descriptor, such as that of standard input, until its end or until it is stopped.

    A thread that waits in `sys.stdin` cannot be ended, and aborts Python when that ends.
    """

    def __init__(self, descriptor: int) -> None:
        self._waits = _Waits(descriptor)
        super().__init__(self._waits)

    def stop(self) -> None:
        """End the stream where it is; may be called from any thread."""
        self._waits.stop()


class _Waits(io.RawIOBase):
    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._woken, self._wake = os.pipe()

    def stop(self) -> None:
        os.write(self._wake, b"\0")

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        ready, _, _ = select.select([self._descriptor, self._woken], [], [])
        if self._woken in ready:
            return 0
        came = os.read(self._descriptor, len(buffer))
        buffer[: len(came)] = came
        return len(came)

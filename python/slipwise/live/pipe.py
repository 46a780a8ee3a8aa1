# SPDX-License-Identifier: Apache-2.0
"""Lines on a stream as a transport: samples on standard input, results as JSON lines to a file."""

from __future__ import annotations

import contextlib
import threading
from collections import Counter
from typing import IO

from slipwise.errors import LogError
from slipwise.live.lines import LineReader, line_of
from slipwise.live.outputs import Output
from slipwise.live.samples import Sample
from slipwise.live.transport import OnSample


class Pipe:
    """Reads lines until the stream ends.

    Args:
        lines: the text stream to read.
        results: where results go as JSON lines; None: nowhere.
    """

    def __init__(self, lines: IO[str], results: IO[str] | None = None) -> None:
        self._lines, self._results = lines, results
        self._reader, self._wrong = LineReader(), WrongLines()
        self._done, self._stopped = threading.Event(), threading.Event()

    def subscribe(self, on_sample: OnSample) -> None:
        """Begin to read."""
        threading.Thread(target=self._read, args=(on_sample,), name="lines", daemon=True).start()

    def publish(self, output: Output) -> None:
        """Write a result as a line; a reader that went away is no error."""
        if self._results is None:
            return
        try:
            self._results.write(line_of(output) + "\n")
            self._results.flush()
        except (BrokenPipeError, ValueError):
            self._results = None

    def notices(self) -> list[str]:
        """Return what was wrong with lines."""
        return self._wrong.take()

    @property
    def finished(self) -> bool:
        """Whether the stream is at its end."""
        return self._done.is_set()

    @property
    def wheels(self) -> bool:
        """Nobody knows before a line says so."""
        return False

    def close(self) -> None:
        """Take no more lines; the thread ends with the stream, or with the process."""
        self._stopped.set()

    def _read(self, on_sample: OnSample) -> None:
        with contextlib.suppress(ValueError, OSError):  # closed under way
            for number, line in enumerate(self._lines, start=1):
                if self._stopped.is_set():
                    return
                for sample in self._wrong.sound(self._reader, line, f"line {number}"):
                    on_sample(sample)
        self._done.set()


class WrongLines:
    """Says the first wrong line of each kind, and how many there were of late."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._new: list[str] = []
        self._count: Counter[str] = Counter()

    def sound(self, reader: LineReader, line: str, place: str) -> list[Sample]:
        """Return the samples of a line; where it cannot be used, none, and why is kept with its place."""
        try:
            return reader.read(line)
        except LogError as problem:
            kind = str(problem)
        with self._lock:
            self._count[kind] += 1
            if self._count[kind] == 1:
                self._new.append(f"left out, {place}: {kind}")
        return []

    def take(self) -> list[str]:
        """Return what is new."""
        with self._lock:
            new, self._new = self._new, []
        return new

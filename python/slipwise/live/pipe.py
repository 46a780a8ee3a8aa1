# SPDX-License-Identifier: Apache-2.0
"""Lines on a stream as a transport: samples on standard input, results as JSON lines to a file."""

from __future__ import annotations

import itertools
import os
import threading
from collections.abc import Iterator
from typing import IO, Protocol

from slipwise.errors import LogError
from slipwise.live.coming import ComingLines, ComingSoon
from slipwise.live.feed import Feed
from slipwise.live.lines import MOST_BYTES, LineReader, line_of
from slipwise.live.outputs import Output
from slipwise.live.samples import Sample, Unusable
from slipwise.live.stoppable_reader import StoppableReader
from slipwise.logs.findings.finding import Finding
from slipwise.logs.options import LogOptions

ENDS_WITHIN = 1.0  # s, of a thread that may still hand over a sample
_AS_IT_IS = LogOptions()


class Pipe(Feed):
    """Reads lines until the stream ends.

    Args:
        lines: the binary stream to read.
        results: where results go as JSON lines, unbuffered; None: nowhere.
        options: how lines are read.

    Raises:
        SettingsError: the options cannot be used live.
    """

    def __init__(
        self, lines: IO[bytes], results: Writable | None = None, options: LogOptions = _AS_IT_IS
    ) -> None:
        self._stream, self._lines = lines, bounded_lines(lines)
        self._results = None if results is None else ResultLines(results)
        self._reader = LineReader(options)
        self._read, self._looked_at = self._read_all(), list[Sample]()
        super().__init__(itertools.chain(self._looked_at, self._read))

    def look(self) -> ComingLines:
        """Wait for the first samples, and return what will come; `subscribe` delivers them all the same."""
        soon = ComingSoon()
        for sample in self._read:
            self._looked_at.append(sample)
            soon.take([sample])
            if soon.enough:
                break
        return soon.found(self._reader.columns)

    def publish(self, output: Output) -> None:
        """Write a result as a line; a reader that went away is no error."""
        if self._results is not None:
            self._results.write(line_of(output))

    def found(self) -> tuple[Finding, ...]:
        """Return what the lines so far show to be wrong."""
        return self._reader.found()

    def notices(self) -> list[str]:
        """Return what was worked out of lines, and what was wrong with results."""
        notes, self._reader.notes = self._reader.notes, []
        return notes if self._results is None else notes + self._results.notices()

    @property
    def finished(self) -> bool:
        """Whether the stream is at its end.

        Raises:
            LogError: it cannot be read further.
        """
        try:
            return super().finished
        except Exception as problem:
            raise LogError(f"the lines cannot be read further: {problem}") from problem

    def close(self) -> None:
        """Take no more lines; the thread ends with the stream, where that can be stopped now."""
        self._stopped.set()
        if isinstance(self._stream, StoppableReader):
            self._stream.stop()
            if self._thread is not None and threading.current_thread() is not self._thread:
                self._thread.join(ENDS_WITHIN)
        if self._results is not None:
            self._results.close()

    def _read_all(self) -> Iterator[Sample]:
        for number, line in enumerate(self._lines, start=1):
            yield from samples_in(self._reader, line, f"line {number}")


def bounded_lines(stream: IO[bytes]) -> Iterator[bytes]:
    """Yield the lines of a stream; of one that is too long its beginning, longer than a line may be."""
    goes_on = False
    while line := stream.readline(MOST_BYTES + 1):
        if not goes_on:
            yield line
        goes_on = not line.endswith(b"\n")


def samples_in(reader: LineReader, line: bytes, place: str) -> list[Sample]:
    """Return the samples of a line; where it cannot be used, why, with its place."""
    try:
        return [placed(sample, place) for sample in reader.read(decoded(line))]
    except LogError as problem:
        why = str(problem)
    except Exception as problem:  # no line ends the thread that reads
        why = f"it cannot be read: {type(problem).__name__}"
    return [placed(Unusable("a line that cannot be used", why, kind=why), place)]


def placed(sample: Sample, place: str) -> Sample:
    """Return a sample; of what cannot be used, where it is too."""
    if not isinstance(sample, Unusable):
        return sample
    return Unusable(sample.reason, f"left out, {place}: {sample.text}", kind=sample.kind)


def decoded(line: bytes) -> str:
    """Return the text of a line.

    Raises:
        LogError: it is too long, or no text.
    """
    if len(line) > MOST_BYTES:
        raise LogError("a line is too long", advice=f"write {MOST_BYTES} bytes at most")
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError as problem:
        raise LogError(
            "a line is not text in UTF-8", advice="write text in UTF-8, one line for each sample"
        ) from problem


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

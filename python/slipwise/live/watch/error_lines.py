# SPDX-License-Identifier: Apache-2.0
"""Says errors alone, for a quiet node."""

from __future__ import annotations

from collections.abc import Callable

from slipwise.live.outputs import Note, Output
from slipwise.live.watch.output_thread import OutputThread
from slipwise.live.watch.status_texts import stamp_text
from slipwise.live.watch.terminal_screen import clean
from slipwise.live.watch.watcher import Watcher


class ErrorLines(Watcher):
    """A line for every note that is an error."""

    def __init__(self, write: Callable[[str], None]) -> None:
        """`write` prints one line, in a thread of its own."""
        self._write = write
        self._thread = OutputThread(self._show, name="slipwise-errors")

    def take(self, output: Output) -> None:
        """Print an output, if it is an error."""
        if isinstance(output, Note) and output.error:
            self._thread.put(output)

    def close(self) -> None:
        """Print what waits."""
        self._thread.close()

    def _show(self, output: Output) -> None:
        if isinstance(output, Note):
            self._write(clean(f"{stamp_text(output.t)}  {output.text}"))

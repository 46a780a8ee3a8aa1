# SPDX-License-Identifier: Apache-2.0
"""Shows the node in the terminal: a screen that refreshes, or plain lines where there is no terminal."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from slipwise.live.outputs import Note, Output, Status
from slipwise.live.validity import model_words
from slipwise.live.watch.history import History
from slipwise.live.watch.status_texts import error_texts, nis_text, slip_texts, stamp_text
from slipwise.live.watch.terminal_screen import clean, screen
from slipwise.live.watch.watcher import Watcher

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

STATE_EVERY = 10.0  # s between two lines of state
_REFRESHES = 2.0  # a second: people read no faster, and each takes milliseconds
CAPACITY = 4096  # outputs that wait, a minute of a busy node
_WAIT = 0.5  # s without an output until `rest` is called

_log = logging.getLogger(__name__)


def terminal_watcher(
    console: Console, write: Callable[[str], None], *, headlines: Sequence[str] = ()
) -> Watcher:
    """Return a screen where `console` is a terminal that can show one, and plain lines elsewhere.

    Args:
        console: what the command line prints to.
        write: prints one line.
        headlines: what stays in sight, such as the address of the page.
    """
    if console.is_terminal and not console.is_dumb_terminal:
        return TerminalScreen(console, headlines=headlines)
    return PlainLines(write, headlines=headlines)


class TerminalScreen(Watcher):
    """The whole terminal shows the state while the node runs; the last of it stays when it ends."""

    def __init__(self, console: Console, *, headlines: Sequence[str] = ()) -> None:
        """Take the terminal over until `close`."""
        from rich.live import Live

        self._console, self._headlines = console, tuple(headlines)
        self._history = History()
        self._live = Live(
            console=console,
            screen=True,
            refresh_per_second=_REFRESHES,
            get_renderable=self._render,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._live.start()
        self._open = True

    def take(self, output: Output) -> None:
        """Show an output at the next refresh."""
        self._history.take(output)

    def close(self) -> None:
        """Give the terminal back and leave the last state in it."""
        if not self._open:
            return
        self._open = False
        with contextlib.suppress(OSError):  # the terminal may be gone
            self._live.stop()
            self._console.print(self._render())

    def _render(self) -> RenderableType:
        return screen(self._history.seen(), self._console.size, self._headlines)


class PlainLines(Watcher):
    """A line for every note and one of state every 10 s, such as for a journal."""

    def __init__(
        self,
        write: Callable[[str], None],
        *,
        headlines: Sequence[str] = (),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`write` prints one line, in a thread of its own; `clock` counts seconds."""
        self._write, self._clock = write, clock
        self._said = -STATE_EVERY + clock()
        self._status: Status | None = None
        self._shown: Status | None = None
        for line in headlines:
            write(clean(line))
        self._thread = OutputThread(self._show, name="slipwise-lines")

    def take(self, output: Output) -> None:
        """Print an output, if it is one that is printed."""
        if isinstance(output, Note | Status):
            self._thread.put(output)

    def close(self) -> None:
        """Print the last state, if it was not."""
        done = self._thread.close()
        if done and self._thread.failure is None and self._status is not self._shown:
            with contextlib.suppress(OSError):
                self._print_state()

    def _show(self, output: Output) -> None:
        if isinstance(output, Note):
            self._write(clean(f"{stamp_text(output.t)}  {output.text}"))
        elif isinstance(output, Status):
            self._status = output
            if self._clock() - self._said >= STATE_EVERY:
                self._said = self._clock()
                self._print_state()

    def _print_state(self) -> None:
        self._shown = self._status
        if self._status is not None:
            self._write(state_line(self._status))


def state_line(status: Status) -> str:
    """Return the state of the node as one line of text."""
    parts = [
        f"{status.state}: {status.why}" if status.why else status.state,
        model_words(status.validity, status.validity_why),
        *([] if "segment" in status.why else [f"{status.segments} segments"]),
    ]
    parts += [
        f"{error.name} error {error.learned} {error.unit} (baseline {error.baseline})"
        for error in error_texts(status)
    ]
    slip = slip_texts(status)
    if slip is not None:
        parts.append(f"slip {slip[0]}, {slip[1]} m/s, {slip[2]} rad/s")
    if status.nis is not None:
        parts.append(f"NIS {nis_text(status)}")
    known = sum(p.validity == "estimated" for p in status.parameters)
    parts.append(f"{known} of {len(status.parameters)} parameters estimated")
    left_out = sum(status.counts.values())
    if left_out:
        parts.append(f"{left_out} left out")
    return clean(f"{stamp_text(status.t)}  {'; '.join(parts)}")


class ErrorLines(Watcher):
    """A line for every note that is an error, for a quiet node."""

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


class OutputThread:
    """A bounded queue and the thread behind it; what finds it full is left out and counted.

    A handler that raises is not called again.
    """

    def __init__(
        self,
        handle: Callable[[Output], None],
        *,
        name: str,
        rest: Callable[[], None] = lambda: None,
        capacity: int = CAPACITY,
    ) -> None:
        """Start the thread.

        Args:
            handle: called in the thread with every output.
            name: of the thread.
            rest: called in the thread after each output, and every half second without one.
            capacity: outputs that may wait.
        """
        self.left_out = 0
        self.failure: Exception | None = None
        self._handle, self._rest = handle, rest
        self._queue: queue.Queue[Output | None] = queue.Queue(capacity)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, output: Output) -> None:
        """Hand an output over without waiting."""
        if self.failure is not None or self._stopped.is_set():
            return
        try:
            self._queue.put_nowait(output)
        except queue.Full:
            self.left_out += 1

    def close(self, timeout: float = 1.5) -> bool:
        """Let the thread finish what waits; return whether it did within `timeout` [s]."""
        self._stopped.set()
        with contextlib.suppress(queue.Full):
            self._queue.put_nowait(None)  # wakes it
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while not (self._stopped.is_set() and self._queue.empty()):
            try:
                output = self._queue.get(timeout=0.05 if self._stopped.is_set() else _WAIT)
            except queue.Empty:
                output = None
            try:
                if output is not None:
                    self._handle(output)
                self._rest()
            except Exception as error:  # whatever it is, the node goes on
                _log.debug("a watcher stopped", exc_info=True)
                self.failure = error
                return

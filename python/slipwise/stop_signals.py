# SPDX-License-Identifier: Apache-2.0
"""SIGINT (Ctrl-C) and SIGTERM: who takes them, and for how long."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
AGAIN = 0.01  # s until a stop that Python ignored is asked for again


class Stopped(KeyboardInterrupt):
    """A KeyboardInterrupt of its own class.

    `python -m` ends by SIGINT, with another exit code than ours, once a plain KeyboardInterrupt has left code
    that was compiled from a text, as dataclasses and named tuples are; even where it was caught above.
    """


@contextlib.contextmanager
def taken_by(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Give both signals to a handler, then to the one before it."""
    before = {number: signal.signal(number, handler) for number in STOP_SIGNALS}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Let both signals wait until the end.

    Their handlers wait, not the signals: a signal that this thread blocks goes to another thread of a
    library, and Python then calls the handler in this one.
    """
    came: list[int] = []
    try:
        with taken_by(lambda sent, _: came.append(sent)):
            yield
    finally:
        for sent in came[:1]:
            signal.raise_signal(sent)


@contextlib.contextmanager
def kept_from_children() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach, from their first instruction on: their parent ends them."""
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # to start it, multiprocessing would let SIGINT through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Interrupt:
    """Raises Stopped on a signal, and remembers it.

    Where Python ignores what is raised, in `__del__` and in callbacks of weak references, it raises again.
    """

    def __init__(self) -> None:
        self.asked = False
        self._taken = taken_by(self._stop)
        self._again: threading.Timer | None = None
        self._report = sys.unraisablehook

    def __enter__(self) -> Interrupt:
        self._taken.__enter__()
        sys.unraisablehook = self._ignored
        return self

    def __exit__(self, *_: object) -> None:
        sys.unraisablehook = self._report
        if self._again is not None:
            self._again.cancel()
            self._again.join()
        self._taken.__exit__(None, None, None)

    def _stop(self, _signal: int, _frame: FrameType | None) -> None:
        self.asked = True
        raise Stopped

    def _ignored(self, unraisable: sys.UnraisableHookArgs) -> None:
        if not isinstance(unraisable.exc_value, Stopped):
            self._report(unraisable)
            return
        main = threading.main_thread().ident
        assert main is not None
        self._again = threading.Timer(AGAIN, signal.pthread_kill, (main, signal.SIGINT))
        self._again.daemon = True
        self._again.start()

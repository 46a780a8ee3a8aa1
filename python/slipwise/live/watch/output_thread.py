# SPDX-License-Identifier: Apache-2.0
"""Outputs handled in a thread of their own, so that no watcher makes the node wait."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
from collections.abc import Callable

from slipwise.live.outputs import Output

CAPACITY = 4096  # outputs that wait, a minute of a busy node
_WAIT = 0.5  # s without an output until `rest` is called

_log = logging.getLogger(__name__)


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

# SPDX-License-Identifier: Apache-2.0
"""Samples from a program as a transport without listeners."""

from __future__ import annotations

import threading
from collections.abc import Iterable

from slipwise.live.outputs import Output
from slipwise.live.samples import Sample
from slipwise.live.transport import OnSample, Transport


class Feed(Transport):
    """Delivers samples one after the other, as fast as they come and the node takes them.

    Args:
        samples: in the order in which they arrive.
    """

    def __init__(self, samples: Iterable[Sample]) -> None:
        self._samples = samples
        self._stopped, self._done = threading.Event(), threading.Event()
        self._thread: threading.Thread | None = None
        self._failure: Exception | None = None

    def subscribe(self, on_sample: OnSample) -> None:
        """Begin to deliver, in a thread."""
        self._thread = threading.Thread(target=self._deliver, args=(on_sample,), name="feed", daemon=True)
        self._thread.start()

    def publish(self, output: Output) -> None:
        """Has no listener."""

    @property
    def finished(self) -> bool:
        """Whether all samples were delivered.

        Raises:
            Exception: what ended the samples early.
        """
        if self._done.is_set() and self._failure is not None:
            raise self._failure
        return self._done.is_set()

    def close(self) -> None:
        """Stop where it is."""
        self._stopped.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)

    def _deliver(self, on_sample: OnSample) -> None:
        try:
            for sample in self._samples:
                if self._stopped.is_set():
                    return
                on_sample(sample)
        except Exception as problem:  # the node's thread raises it
            self._failure = None if self._stopped.is_set() else problem
        self._done.set()

# SPDX-License-Identifier: Apache-2.0
"""A run over windows that learns only as far as requested, and keeps no posterior but the present one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.calibration.prepared_run import WindowSet

UpdateT = TypeVar("UpdateT")
UpdateT_co = TypeVar("UpdateT_co", covariant=True)


class OnlineLearner(Protocol[UpdateT_co]):
    """Anything that learns windows in order, and says what it believes now."""

    def learn(self, inputs: _core.InputHistory, segment: _core.Segment, /) -> UpdateT_co:
        """Learn one window and say how it was taken in."""
        ...

    def posterior(self) -> Posterior:
        """Return the posterior now."""
        ...


class CausalPass(Generic[UpdateT]):
    """Learns windows in order; memory does not grow with their number."""

    def __init__(
        self,
        learner: OnlineLearner[UpdateT],
        windows: WindowSet,
        observer: Callable[[int, UpdateT, Posterior], None] | None = None,
        *,
        pace: WindowSet | None = None,
    ) -> None:
        """Start before the first window.

        Args:
            learner: what learns; it has learned nothing yet.
            windows: what it learns, of any length, overlapping or not.
            observer: gets each window's index, its update, and the posterior after it.
            pace: posteriors are requested by counts of these windows, where not of `windows` themselves.
        """
        self._learner, self._windows, self._observer = learner, windows, observer
        self._passed = None if pace is None else windows.passed(pace)
        self._learned = 0

    @property
    def learned(self) -> int:
        """How many of its own windows are learned."""
        return self._learned

    def passed(self, count: int) -> int:
        """How many of its own windows had ended when the last of `count` windows of the pace did."""
        if self._passed is None or count == 0:
            return count
        return int(self._passed[count - 1])

    def posterior(self, count: int) -> Posterior:
        """Return the posterior once `count` windows have passed.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        until = self.passed(count)
        if until < self._learned:
            raise ValueError(f"the posterior after {until} windows is gone: {self._learned} are learned")
        for i in range(self._learned, until):
            update = self._learner.learn(self._windows.input_history(i), self._windows.segments[i])
            self._learned = i + 1
            if self._observer is not None:
                self._observer(i, update, self._learner.posterior())
        return self._learner.posterior()

    def finish(self) -> Posterior:
        """Learn the remaining segments and return the last posterior."""
        return self.posterior(len(self._windows if self._passed is None else self._passed))

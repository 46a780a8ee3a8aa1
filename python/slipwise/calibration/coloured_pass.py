# SPDX-License-Identifier: Apache-2.0
"""How slip wanders about what a pass believes, learned beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.settings import Settings


class ColouredPass:
    """Foretells each window from what the windows just before it say of the slip, before it is learned."""

    def __init__(self, belief: Callable[[int], Belief], windows: WindowSet, settings: Settings) -> None:
        """`belief` says what a pass believes after so many windows; it has not been asked yet."""
        self._believed, self._windows = belief, windows
        self._shape = settings.filter_settings().noise.shape
        self._coloured = _core.ColouredSlip(settings.coloured_settings())
        self._learned = 0

    def belief(self, count: int) -> Belief:
        """Return the belief once `count` windows have passed.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        for i in range(self._learned, count):
            before = self._believed(i)
            recent = self._windows.recent(i, int(self._windows.position[i]), float(self._windows.start[i]))
            track = self._windows.track(i, before.limited)
            segments = [*recent, self._windows.segments[i]]
            self._coloured.learn(motion_belief(before, self._shape), track, segments)
        self._learned = max(self._learned, count)
        return replace(self._believed(count), coloured=_core.ColouredSlip(self._coloured))


def motion_belief(belief: Belief, shape: _core.MotionNoise) -> _core.MotionBelief:
    """Return the belief as the core takes it; `shape` is that of the noise where the belief has none."""
    estimate = _core.Estimate(belief.mean, belief.covariance)
    return _core.MotionBelief(
        belief.motion, estimate, belief.prior_std, belief.noise or shape, belief.noise_scale
    )

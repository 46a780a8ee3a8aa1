# SPDX-License-Identifier: Apache-2.0
"""What is true of a prediction's start alone, learned beside a pass: the slip now, and the pose now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.settings import Settings


class StartPass:
    """Foretells each window from the windows and poses just before it, before it is learned."""

    def __init__(
        self,
        belief: Callable[[int], Belief],
        windows: WindowSet,
        settings: Settings,
        *,
        of_slip: Callable[[int], Belief] | None = None,
    ) -> None:
        """`belief` says what a pass believes after so many windows; it has not been asked yet.

        `of_slip` says what it believes where it is asked about slip, where these may differ.
        """
        self._believed, self._of_slip, self._windows = belief, of_slip or belief, windows
        self._shape = settings.filter_settings().noise.shape
        self._coloured = _core.ColouredSlip(settings.coloured_settings()) if settings.coloured.learn else None
        self._start = _core.StartPose(settings.start_settings()) if settings.start.learn else None
        self._learned = 0

    def belief(self, count: int) -> Belief:
        """Return the belief once `count` windows have passed.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        for i in range(self._learned, count):
            self._learn(i)
        self._learned = max(self._learned, count)
        return replace(
            self._believed(count),
            coloured=None if self._coloured is None else _core.ColouredSlip(self._coloured),
            start=None if self._start is None else _core.StartPose(self._start),
        )

    def _learn(self, i: int) -> None:
        windows = self._windows
        before = replace(self._of_slip(i), coloured=self._coloured)
        known, coloured = motion_belief(before, self._shape), _coloured(before)
        track, segment = windows.track(i, before.limited), windows.segments[i]
        recent = windows.recent(i, int(windows.position[i]), float(windows.start[i]))
        now = coloured.now(known, track, recent)
        if self._start is not None:
            expected = coloured.predict(known, track, now, segment)
            self._start.learn(known, track, windows.seen(i, self._start.reach), segment, expected)
        if self._coloured is not None:
            self._coloured.learn(known, track, now, segment)


def motion_belief(belief: Belief, shape: _core.MotionNoise) -> _core.MotionPosterior:
    """Return the belief as the core takes it; `shape` is that of the noise where the belief has none."""
    estimate = _core.Estimate(belief.mean, belief.covariance)
    return _core.MotionPosterior(
        belief.motion, estimate, belief.prior_std, belief.noise or shape, belief.noise_scale
    )


def expected_from_measured(
    belief: Belief,
    shape: _core.MotionNoise,
    track: _core.InputTrack,
    segment: _core.Segment,
    recent: list[_core.Segment],
) -> _core.ExpectedPose:
    """Predict a window from the pose measured at its start, following slip that wanders through `recent`."""
    known, coloured = motion_belief(belief, shape), _coloured(belief)
    return coloured.predict(known, track, coloured.now(known, track, recent), segment)


def _coloured(belief: Belief) -> _core.ColouredSlip:
    """Return how slip wanders about the belief; where that is not learned, it does not."""
    return belief.coloured or _core.ColouredSlip(_core.WanderLaw([], np.empty(0)))

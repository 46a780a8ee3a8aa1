# SPDX-License-Identifier: Apache-2.0
"""Prequential prediction: each window predicted from what had been learned an embargo before its start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.predictions import Predictions, normalised_squared, residual

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GROWTH_PRIOR_WINDOWS = 5.0  # the noise shape's own growth counts as much as this many held-out windows
LARGEST_NIS = (
    30.0  # a held-out window counts at most this much: one pose jump must not blow up the covariance
)


@dataclass(frozen=True, eq=False)
class Forecaster:
    """One method at work: a model, and the belief after any number of learned windows."""

    method: str
    model: _core.MotionModel
    noise: _core.MotionNoise
    belief: Callable[[int], Belief]
    starts_from_wheels: bool  # the drive's measured twist at the start is used
    causal: bool = True  # False: it learned from the whole log, the windows to predict included


def learned_counts(learned: WindowSet, targets: WindowSet) -> tuple[Ints, Ints]:
    """Return how many windows count as learned for each target: after the embargo, and in-sample."""
    embargoed = learned.count_until(targets.position, targets.start - targets.length)
    in_sample = learned.count_until(targets.position, targets.end)
    return embargoed, in_sample


def forecast(forecaster: Forecaster, learned: WindowSet, targets: WindowSet) -> Predictions:
    """Predict every target window causally, and once more after having learned it (the thesis's residual)."""
    counts, in_sample_counts = learned_counts(learned, targets)
    size = len(targets)
    pose, covariance, in_sample = np.empty((size, 3)), np.empty((size, 3, 3)), np.empty((size, 3))
    for i, segment in enumerate(targets.segments):
        belief = forecaster.belief(int(counts[i]))
        at = _core.linearize_segment(forecaster.model, belief.mean, targets.track(i), segment)
        pose[i] = at.predicted.vector()
        covariance[i] = _core.prediction_covariance(
            at, belief.covariance, forecaster.noise, belief.noise_scale
        )
        later = forecaster.belief(int(in_sample_counts[i]))
        in_sample[i] = _core.integrate_segment(
            forecaster.model, later.mean, targets.track(i), segment, _core.Integrator.Exact
        ).poses[-1]
    known = targets.count_until(targets.position, targets.start - targets.length)
    growth = _causal_growth(known, normalised_squared(residual(targets.measured, pose), covariance))
    left = residual(targets.measured, in_sample)
    return Predictions(
        method=forecaster.method,
        horizon=targets.length,
        run=np.array([targets.drive[p].index for p in targets.position], dtype=np.int64),
        t_start=targets.start,
        t_end=targets.end,
        pose=pose,
        covariance=covariance * growth[:, None, None],
        growth=growth,
        measured=targets.measured,
        learned_until=_learned_until(forecaster, (learned, counts), (targets, known), targets),
        in_sample=np.column_stack((np.hypot(left[:, 0], left[:, 1]), np.abs(left[:, 2]))),
    )


def _causal_growth(known: Ints, nis: Floats) -> Floats:
    """Factor of each target's covariance from the `known` held-out windows before it, [N]."""
    sums = np.concatenate(([0.0], np.cumsum(np.minimum(nis, LARGEST_NIS) / 3.0)))
    return np.asarray((sums[known] + GROWTH_PRIOR_WINDOWS) / (known + GROWTH_PRIOR_WINDOWS), dtype=np.float64)


def final_growth(predictions: Predictions) -> float:
    """Factor of the covariance at this horizon from all held-out windows."""
    nis = np.minimum(predictions.nis * predictions.growth, LARGEST_NIS)
    return float((nis.sum() / 3.0 + GROWTH_PRIOR_WINDOWS) / (len(predictions) + GROWTH_PRIOR_WINDOWS))


def _learned_until(
    forecaster: Forecaster,
    learned: tuple[WindowSet, Ints],
    scored: tuple[WindowSet, Ints],
    targets: WindowSet,
) -> Floats:
    """The latest time of the target's run at which something that its prediction uses was measured, [N] s."""
    if not forecaster.causal:
        return np.array([run.run.poses.t[-1] for run in targets.drive])[targets.position]
    begin = np.array([min(float(run.inputs.t[0]), float(run.run.poses.t[0])) for run in targets.drive])
    until = np.minimum(begin[targets.position], targets.start)
    for windows, counts in (learned, scored):
        last = np.maximum(counts - 1, 0)
        if len(windows):
            same_run = (counts > 0) & (windows.position[last] == targets.position)
            until = np.where(same_run, np.maximum(until, windows.end[last]), until)
    has_wheels = np.array([run.wheels is not None for run in targets.drive])
    return np.where(forecaster.starts_from_wheels & has_wheels[targets.position], targets.start, until)

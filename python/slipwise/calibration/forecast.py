# SPDX-License-Identifier: Apache-2.0
"""Prequential prediction: each window predicted from what had been learned an embargo before its start.

Parameters are those of the embargo. What is true of the start alone is measured until then: the drive's
twist, the slip now where it wanders, and the pose now.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.predictions import Predictions, normalised_squared, residual
from slipwise.calibration.start_pass import expected_from_measured, motion_belief
from slipwise.calibration.tails import Tails, learn_tails
from slipwise.models.schema import Tail

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Forecaster:
    """One method at work: the belief after any number of learned windows."""

    method: str
    noise: _core.MotionNoise
    belief: Callable[[int], Belief]  # asked for in the order learned: the number of windows never decreases
    starts_from_wheels: bool  # the drive's measured twist at the start is used
    follows: bool = True  # slip that wanders is followed through the last windows before the start
    causal: bool = True  # False: it learned from the whole log, the windows to predict included


def learned_counts(learned: WindowSet, targets: WindowSet) -> tuple[Ints, Ints]:
    """Return how many windows count as learned for each target: after the embargo, and in-sample."""
    embargoed = learned.count_until(targets.position, targets.start - targets.length)
    in_sample = learned.count_until(targets.position, targets.end)
    return embargoed, in_sample


@dataclass(frozen=True, eq=False)
class _Draft:
    """The predictions of one set of targets while they are being made, [N] each."""

    targets: WindowSet
    counts: Ints  # windows learned before the prediction
    recent: Ints  # windows that ended by its start; the last of them tell of the slip now
    in_sample_counts: Ints
    pose: Floats
    from_measured: Floats  # `pose`, had it started at the measured one
    covariance: Floats
    usual: Floats  # squared length of the error from the measured start, nothing recent known of the slip
    in_sample: Floats
    structure: Ints  # that predicted: the errors of each are a population of their own
    from_poses: Bools  # whether the start is where the poses until then say together


def forecast(forecaster: Forecaster, learned: WindowSet, targets: WindowSet) -> Predictions:
    """Predict every target window causally, and once more after having learned it (the thesis's residual)."""
    return forecast_all(forecaster, learned, [targets])[0]


def forecast_all(
    forecaster: Forecaster, learned: WindowSet, sets: Sequence[WindowSet]
) -> tuple[Predictions, ...]:
    """Predict the targets of several horizons in one pass over what is learned, so that no belief is kept."""
    drafts = [_draft(learned, targets) for targets in sets]
    moments = [c for draft in drafts for c in (draft.counts, draft.in_sample_counts)]
    kind = np.repeat(np.arange(len(moments)), [len(counts) for counts in moments])
    index = np.concatenate([np.arange(len(counts)) for counts in moments])
    count = np.concatenate(moments)
    for k in np.argsort(count, kind="stable").tolist():
        belief, draft = forecaster.belief(int(count[k])), drafts[kind[k] // 2]
        if kind[k] % 2 == 0:
            _predict((forecaster, learned), belief, draft, int(index[k]))
        else:
            _predict_in_sample(forecaster, belief, draft, int(index[k]))
    return tuple(_finished(forecaster, learned, draft) for draft in drafts)


def _draft(learned: WindowSet, targets: WindowSet) -> _Draft:
    counts, in_sample_counts = learned_counts(learned, targets)
    size = len(targets)
    return _Draft(
        targets,
        counts,
        learned.count_until(targets.position, targets.start),
        in_sample_counts,
        np.empty((size, 3)),
        np.empty((size, 3)),
        np.empty((size, 3, 3)),
        np.empty(size),
        np.empty((size, 3)),
        np.zeros(size, dtype=np.int64),
        np.zeros(size, dtype=np.bool_),
    )


def _predict(given: tuple[Forecaster, WindowSet], belief: Belief, draft: _Draft, i: int) -> None:
    forecaster, learned = given
    targets, position = draft.targets, int(draft.targets.position[i])
    track, segment = targets.track(i, belief.limited), targets.segments[i]
    if belief.coloured is None or not forecaster.follows:
        draft.recent[i] = 0
    recent = learned.recent(int(draft.recent[i]), position, float(targets.start[i]))
    usual, expected = (
        expected_from_measured(belief, forecaster.noise, track, segment, seen) for seen in ([], recent)
    )
    draft.from_measured[i] = expected.pose
    expected = _core.starting_at(_start(forecaster, belief, targets, i), expected)
    draft.pose[i], draft.covariance[i] = expected.pose, expected.covariance
    draft.usual[i] = _squared(targets, i, usual.pose, usual.covariance)
    draft.structure[i] = belief.structure
    draft.from_poses[i] = belief.start is not None


def _squared(targets: WindowSet, i: int, pose: Floats, covariance: Floats) -> float:
    error = residual(targets.measured[i : i + 1], pose[None])
    return float(normalised_squared(error, covariance[None])[0])


def _predict_in_sample(forecaster: Forecaster, belief: Belief, draft: _Draft, i: int) -> None:
    targets = draft.targets
    path = _core.integrate_segment(
        belief.motion,
        belief.mean,
        targets.track(i, belief.limited),
        targets.segments[i],
        _core.Integrator.Exact,
    )
    end = _core.Pose2(*path.sensor_poses[-1].tolist())
    draft.in_sample[i] = _core.compose(_start(forecaster, belief, targets, i), end).vector()


def _start(forecaster: Forecaster, belief: Belief, targets: WindowSet, i: int) -> _core.Pose2:
    """Where window i starts, as seen from the pose measured there."""
    if belief.start is None:
        return _core.Pose2(0.0, 0.0, 0.0)
    known, track = motion_belief(belief, forecaster.noise), targets.track(i, belief.limited)
    return belief.start.offset(known, track, targets.seen(i, belief.start.reach), targets.segments[i])


def _finished(forecaster: Forecaster, learned: WindowSet, draft: _Draft) -> Predictions:
    targets, pose = draft.targets, draft.pose
    known = targets.count_until(targets.position, targets.start - targets.length)
    squared = normalised_squared(residual(targets.measured, pose), draft.covariance)
    tails = _tails_of_each(known, squared, draft.structure)
    left = residual(targets.measured, draft.in_sample)
    return Predictions(
        method=forecaster.method,
        horizon=targets.length,
        run=np.array([targets.drive[p].index for p in targets.position], dtype=np.int64),
        t_start=targets.start,
        t_end=targets.end,
        pose=pose,
        covariance=draft.covariance * tails.growth[:, None, None],
        growth=tails.growth,
        dof=tails.dof,
        usual_nis=draft.usual,
        structure=draft.structure,
        measured=targets.measured,
        learned_until=_learned_until(
            forecaster, ((learned, draft.counts), (learned, draft.recent), (targets, known)), draft
        ),
        in_sample=np.column_stack((np.hypot(left[:, 0], left[:, 1]), np.abs(left[:, 2]))),
        from_measured=draft.from_measured,
    )


def _tails_of_each(known: Ints, squared: Floats, structure: Ints) -> Tails:
    """The tails of each structure's predictions, from the errors of that structure alone."""
    growth, dof = np.empty(len(known)), np.empty(len(known))
    for each in np.unique(structure).tolist():
        at = structure == each
        earlier = np.concatenate(([0], np.cumsum(at)))
        tails = learn_tails(earlier[known[at]], squared[at])
        growth[at], dof[at] = tails.growth, tails.dof
    return Tails(growth, dof)


def final_tail(predictions: Predictions, structure: int) -> Tail:
    """Growth and degrees of freedom at this horizon from all held-out windows of the structure kept.

    They go with a model file, which does not know where slip that wanders is.
    """
    squared = predictions.usual_nis[predictions.structure == structure]
    tails = learn_tails(np.array([len(squared)]), squared)
    return Tail(growth=float(tails.growth[0]), dof=float(tails.dof[0]))


def _learned_until(forecaster: Forecaster, used: Sequence[tuple[WindowSet, Ints]], draft: _Draft) -> Floats:
    """The latest time of the target's run at which something that its prediction uses was measured, [N] s."""
    targets = draft.targets
    if not forecaster.causal:
        return np.array([run.run.poses.t[-1] for run in targets.drive])[targets.position]
    begin = np.array([min(float(run.inputs.t[0]), float(run.run.poses.t[0])) for run in targets.drive])
    until = np.minimum(begin[targets.position], targets.start)
    for windows, counts in used:
        last = np.maximum(counts - 1, 0)
        if len(windows):
            same_run = (counts > 0) & (windows.position[last] == targets.position)
            until = np.where(same_run, np.maximum(until, windows.end[last]), until)
    has_wheels = np.array([run.wheels is not None for run in targets.drive])
    from_wheels = forecaster.starts_from_wheels & has_wheels[targets.position]
    return np.where(from_wheels | draft.from_poses, targets.start, until)

# SPDX-License-Identifier: Apache-2.0
"""Prequential prediction by other methods than the learner: from what was known an embargo before a start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictions import Predictions, normalised_squared, residual
from slipwise.calibration.prepared_run import WindowSet
from slipwise.models.schema import StudentT
from slipwise.segments import input_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_BEFORE = 20.0  # s of commands before a window; a car remembers no more


@dataclass(frozen=True, eq=False)
class Predictor:
    """One method at work: the posterior after any number of learned windows."""

    method: str
    noise: _core.MotionNoise
    posterior: Callable[[int], Posterior]  # requested in the order learned: windows never decrease
    starts_from_wheels: bool  # the actuator's measured twist at the start is used
    causal: bool = True  # False: it learned from the whole log, the windows to predict included
    student: Callable[[float], StudentT] | None = None  # of a horizon [s]; without it, from earlier errors


def learned_counts(learned: WindowSet, targets: WindowSet, embargo: float | None = None) -> tuple[Ints, Ints]:
    """Return how many windows count as learned for each target: after the embargo, and in-sample."""
    embargoed = learned.count_until(targets.position, _known_until(targets, embargo))
    in_sample = learned.count_until(targets.position, targets.end)
    return embargoed, in_sample


def _known_until(targets: WindowSet, embargo: float | None) -> Floats:
    """Return up to when each prediction knows what was measured [s]: without an embargo, a horizon before."""
    return targets.start - (targets.length if embargo is None else embargo)


@dataclass(frozen=True, eq=False)
class _Draft:
    """The predictions of one set of targets while they are being made, [N] each."""

    targets: WindowSet
    embargo: float | None  # s
    counts: Ints  # windows learned before the prediction
    in_sample_counts: Ints
    pose: Floats
    covariance: Floats
    in_sample: Floats
    structure: Ints  # that predicted


def predictions_of(predictor: Predictor, learned: WindowSet, targets: WindowSet) -> Predictions:
    """Predict every target window causally, and once more after having learned it (the thesis's residual)."""
    return predict_all(predictor, learned, [targets])[0]


def predict_all(
    predictor: Predictor, learned: WindowSet, sets: Sequence[WindowSet], embargo: float | None = None
) -> tuple[Predictions, ...]:
    """Predict the targets of several horizons in one run over the learned model, and keep no posterior.

    What was measured within `embargo` [s] before a prediction does not count; None: within its horizon.
    """
    drafts = [_draft(learned, targets, embargo) for targets in sets]
    moments = [c for draft in drafts for c in (draft.counts, draft.in_sample_counts)]
    kind = np.repeat(np.arange(len(moments)), [len(counts) for counts in moments])
    index = np.concatenate([np.arange(len(counts)) for counts in moments])
    count = np.concatenate(moments)
    for k in np.argsort(count, kind="stable").tolist():
        posterior, draft = predictor.posterior(int(count[k])), drafts[kind[k] // 2]
        if kind[k] % 2 == 0:
            _predict(predictor, posterior, draft, int(index[k]))
        else:
            _predict_in_sample(posterior, draft, int(index[k]))
    return tuple(_finished(predictor, learned, draft) for draft in drafts)


def _draft(learned: WindowSet, targets: WindowSet, embargo: float | None) -> _Draft:
    counts, in_sample_counts = learned_counts(learned, targets, embargo)
    size = len(targets)
    return _Draft(
        targets,
        embargo,
        counts,
        in_sample_counts,
        np.empty((size, 3)),
        np.empty((size, 3, 3)),
        np.empty((size, 3)),
        np.zeros(size, dtype=np.int64),
    )


def _predict(predictor: Predictor, posterior: Posterior, draft: _Draft, i: int) -> None:
    known = posterior.for_core(predictor.noise)
    disturbance = posterior.disturbance or _core.DisturbanceFilter(_core.DisturbanceModel([], np.empty(0)))
    history, segment = draft.targets.input_history(i, posterior.limits), draft.targets.segments[i].foreseen()
    expected = disturbance.predict(known, history, disturbance.now(known, history, []), segment)
    draft.pose[i] = expected.pose
    draft.covariance[i] = expected.covariance + _of_curves(posterior, draft.targets, i)
    draft.structure[i] = posterior.structure


def _of_curves(posterior: Posterior, targets: WindowSet, i: int) -> Floats:
    """Covariance of the pose of window i, of what a car never showed of its curves, [3, 3]."""
    car, segment = posterior.car, targets.segments[i].foreseen()
    rows = input_rows(targets.drive[targets.position[i]].run.commands)
    if car is None or not len(rows):
        return np.zeros((3, 3))
    given = rows[
        np.searchsorted(rows[:, 0], segment.start - _BEFORE) : np.searchsorted(rows[:, 0], segment.end)
    ]
    driven = targets.histories[i].rows()
    at_start = driven[max(int(np.searchsorted(driven[:, 0], segment.start, side="right")) - 1, 0)]
    commands = _core.InputHistory(*(np.ascontiguousarray(column) for column in given.T))
    begin, measured = float(given[0, 0]), (segment.start, float(at_start[1]))
    twists, spread = car.twists(commands, begin, measured), car.spread(commands, begin, measured)
    end = [segment.end]
    return _core.input_covariances(posterior.motion, posterior.mean, twists, spread, segment, end)[0]


def _predict_in_sample(posterior: Posterior, draft: _Draft, i: int) -> None:
    history, segment = draft.targets.input_history(i, posterior.limits), draft.targets.segments[i].foreseen()
    path = _core.integrate_segment(posterior.motion, posterior.mean, history, segment, _core.Integrator.Exact)
    draft.in_sample[i] = path.sensor_poses[-1]


def _finished(predictor: Predictor, learned: WindowSet, draft: _Draft) -> Predictions:
    targets, known = draft.targets, known_windows(draft.targets, draft.embargo)
    until = _learned_until(predictor, ((learned, draft.counts), (targets, known)), targets)
    student = None if predictor.student is None else predictor.student(targets.length)
    proposed = ProposedPoses(draft.pose, draft.covariance, draft.in_sample, draft.structure, student)
    return scored_predictions(predictor.method, targets, proposed, until, known)


@dataclass(frozen=True, eq=False)
class ProposedPoses:
    """What a method proposes for the windows of a set, [N] each."""

    pose: Floats  # [N, 3] T_start_end
    covariance: Floats  # [N, 3, 3] without the correction by earlier errors
    in_sample: Floats  # [N, 3] pose after learning the window
    structure: Ints  # of STRUCTURES
    student: StudentT | None = None  # tails that the method states; without them, those of earlier errors


def known_windows(targets: WindowSet, embargo: float | None = None) -> Ints:
    """Return how many of the targets had ended an embargo before each began, one horizon by default, [N]."""
    return targets.count_until(targets.position, _known_until(targets, embargo))


def scored_predictions(
    method: str,
    targets: WindowSet,
    proposed: ProposedPoses,
    learned_until: Floats,
    known: Ints | None = None,
) -> Predictions:
    """Return the predictions beside what was measured, with the tails that earlier errors show.

    `known` is how many earlier errors those are; without it, those one horizon before.
    """
    squared = normalised_squared(residual(targets.measured, proposed.pose), proposed.covariance)
    students: Sequence[StudentT | _core.StudentT]
    if proposed.student is not None:
        students = [proposed.student] * len(squared)
    else:
        students = _tails(known_windows(targets) if known is None else known, squared)
    inflation = np.array([tail.inflation for tail in students])
    left = residual(targets.measured, proposed.in_sample)
    return Predictions(
        method=method,
        horizon=targets.length,
        run=np.array([targets.drive[p].index for p in targets.position], dtype=np.int64),
        t_start=targets.start,
        t_end=targets.end,
        pose=proposed.pose,
        covariance=proposed.covariance * inflation[:, None, None],
        inflation=inflation,
        dof=np.array([tail.dof for tail in students]),
        nominal_nis=squared,
        structure=proposed.structure,
        measured=targets.measured,
        learned_until=learned_until,
        in_sample=np.column_stack((np.hypot(left[:, 0], left[:, 1]), np.abs(left[:, 2]))),
    )


def _tails(known: Ints, squared: Floats) -> list[_core.StudentT]:
    """The Student t of each prediction, from the errors known before it; their number never decreases."""
    calibration = _core.StudentCalibration()
    taken, found = 0, [calibration.fitted()]
    for count in known.tolist():
        for value in squared[taken:count].tolist():
            calibration.learn(value)
        found.append(calibration.fitted() if count > taken else found[-1])
        taken = max(taken, count)
    return found[1:]


def final_student(predictions: Predictions) -> StudentT:
    """Inflation and degrees of freedom at this horizon from all held-out windows.

    They go with a model file, which does not know the slip disturbance of the moment.
    """
    calibration = _core.StudentCalibration()
    for value in predictions.nominal_nis.tolist():
        calibration.learn(value)
    return student_of(calibration.fitted())


def student_of(student: _core.StudentT) -> StudentT:
    """Return a Student t as the model file has it."""
    return StudentT(inflation=student.inflation, dof=student.dof)


def _learned_until(
    predictor: Predictor, used: Sequence[tuple[WindowSet, Ints]], targets: WindowSet
) -> Floats:
    """The latest time of the target's run at which something that its prediction uses was measured, [N] s."""
    if not predictor.causal:
        return np.array([run.end for run in targets.drive])[targets.position]
    begin = np.array([min(float(run.inputs.t[0]), run.begin) for run in targets.drive])
    until = np.minimum(begin[targets.position], targets.start)
    for windows, counts in used:
        last = np.maximum(counts - 1, 0)
        if len(windows):
            same_run = (counts > 0) & (windows.position[last] == targets.position)
            until = np.where(same_run, np.maximum(until, windows.end[last]), until)
    has_wheels = np.array([run.wheels is not None for run in targets.drive])
    from_wheels = predictor.starts_from_wheels & has_wheels[targets.position]
    return np.where(from_wheels, targets.start, until)

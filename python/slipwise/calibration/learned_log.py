# SPDX-License-Identifier: Apache-2.0
"""A log pushed through the streaming learner, once: what was learned, and how it predicted on the way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.coming import coming_of_runs
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.learned import Learned, judged_horizon
from slipwise.calibration.learner import LIMITS, STRUCTURES, Posterior, Progress, posterior_of
from slipwise.calibration.predictions import Predictions, residual
from slipwise.calibration.predictors import student_of
from slipwise.calibration.prepared_run import PreparedRun
from slipwise.calibration.result import History
from slipwise.calibration.settings import Settings
from slipwise.calibration.source_knowledge import LearnedSource, learned_sources
from slipwise.calibration.surface_course import course_of
from slipwise.logs.log import Run
from slipwise.models.schema import MeasuredBody
from slipwise.segments import car_prior, recording_of, source_names, wheelbase_of

Floats = NDArray[np.float64]

STEPS = 20  # pieces in which a run is pushed, so that progress can be shown


@dataclass(frozen=True)
class Keep:
    """What a model file and its report need beside predictions."""

    wheel_separation: float  # m, nominal: where the search for limits of the sides begins


def learn_log(  # noqa: PLR0913 - six things, each of its own sort
    drive: tuple[PreparedRun, ...],
    settings: Settings,
    horizons: Sequence[float],
    *,
    keep: Keep | None = None,
    embargo: float | None = None,
    progress: Progress | None = None,
) -> Learned:
    """Push runs through a learner in one pass.

    Args:
        drive: the runs, in the order of time.
        settings: what to learn and how.
        horizons: of the predictions [s].
        embargo: how old the parameters of predictions are at least [s]; None: one horizon.
        keep: what a model file and its report need beside predictions: the history, and limits.
        progress: called with the fraction done, 0 to 1.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    learner = new_learner(
        [run.run for run in drive], drive[0].input_name, settings, horizons, embargo=embargo
    )
    return learn_with(learner, drive, horizons, keep=keep, progress=progress)


def new_learner(  # noqa: PLR0913 - six things, each of its own sort
    runs: Sequence[Run],
    input_name: str,
    settings: Settings,
    horizons: Sequence[float],
    *,
    remember: bool = False,
    embargo: float | None = None,
) -> _core.MotionLearner:
    """Return a learner that knows nothing yet but what sort of vehicle and of poses the runs are of.

    Args:
        runs: that it will learn from.
        input_name: "command" or "wheel".
        settings: what to learn and how.
        horizons: of the predictions [s].
        remember: keep surfaces that are driven on, and recall them.
        embargo: how old the parameters of predictions are at least [s]; None: one horizon.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    core = core_settings(
        settings,
        input_name,
        horizons,
        coming=coming_of_runs(runs),
        remember=remember,
        car=car_prior(runs),
        wheelbase=None if car_prior(runs) is not None else wheelbase_of(runs),
    )
    stream = core.stream  # a copy
    stream.embargo = embargo
    core.stream = stream
    return _core.MotionLearner(core)


def learn_with(
    learner: _core.MotionLearner,
    drive: tuple[PreparedRun, ...],
    horizons: Sequence[float],
    *,
    keep: Keep | None = None,
    progress: Progress | None = None,
) -> Learned:
    """Push runs through a learner that is there already; else as `learn_log`."""
    events: list[_core.LearnerEvent] = []
    for done in pushed(learner, drive):
        events += [event for event in learner.events() if keep is not None and event.kind == LEARNED]
        if progress is not None:
            progress(done)
    return learned_of(learner, events, horizons, drive, keep)


def learned_of(
    learner: _core.MotionLearner,
    events: Sequence[_core.LearnerEvent],
    horizons: Sequence[float],
    drive: tuple[PreparedRun, ...],
    keep: Keep | None,
) -> Learned:
    """Return what a learner made of all that was pushed.

    Args:
        learner: which has learned it.
        events: of segments learned, where the history is kept.
        horizons: of the predictions [s].
        drive: the runs that were pushed.
        keep: what is needed beside predictions.
    """
    model = learner.model()
    learned = learned_now(
        learner,
        model,
        None if keep is None else found_limits(learner, model, keep.wheel_separation),
        held_out_predictions(model, horizons, drive),
        learned_sources(learner, source_names(run.run for run in drive)),
    )
    if keep is None:
        return learned
    several = learner.settings.hypotheses.several
    return replace(learned, history=_history(events, model.motion, learned.bases, drive, several=several))


def learned_now(
    learner: _core.MotionLearner,
    model: _core.LearnedModel,
    found: _core.ActuatorLimits | None,
    held_out: tuple[tuple[Predictions, ...], tuple[Predictions, ...]],
    sources: tuple[LearnedSource, ...],
) -> Learned:
    """Return what a learner has learned, without a history.

    Args:
        learner: which has learned it.
        model: its.
        found: of limits of the actuator, where these were looked for.
        held_out: predictions of the model and of the baseline, see `held_out_predictions`.
        sources: of poses, where there are several.
    """
    predictions, baseline = held_out
    return Learned(
        kept=_kept_posterior(model, found),
        identifiable=posterior_of(model.slip, model.disturbance),
        predictions=predictions,
        baseline=baseline,
        students={
            each.horizon: student_of(student)
            for each, student in zip(predictions, model.students, strict=True)
            if len(each)
        },
        history=None,
        bases=tuple(basis.name for basis in learner.settings.hypotheses.bases),
        limits=None if found is None else found.search,
        car=model.car,
        sources=sources,
        body=measured_body(model),
        evidence=model.evidence,
        again=_again(model, found, predictions),
    )


def _again(
    model: _core.LearnedModel, found: _core.ActuatorLimits | None, predictions: tuple[Predictions, ...]
) -> Floats | None:
    """Errors over the last segments of the horizon that is judged, by the model that is kept, [N, 2]."""
    if not predictions:
        return None
    judged = judged_horizon([len(each) for each in predictions])
    poses = model.predicted_again(judged, found)
    measured = predictions[judged].measured
    return _errors(measured[len(measured) - len(poses) :], poses)


def found_limits(
    learner: _core.MotionLearner, model: _core.LearnedModel, wheel_separation: float
) -> _core.ActuatorLimits | None:
    """Look for limits of the actuator; a car's curves hold a dead band and a top speed already."""
    return None if model.car is not None else learner.find_limits(wheel_separation)


def _kept_posterior(model: _core.LearnedModel, found: _core.ActuatorLimits | None) -> Posterior:
    """Return what goes into a model: behind limits of the actuator, where these were found and kept."""
    motion = (found.posterior if found is not None else None) or model.motion
    kept = posterior_of(motion, model.disturbance)
    return replace(kept, limits=found.search.limits) if found and motion.structure == LIMITS else kept


LEARNED = _core.EventKind.SegmentLearned
Cue = tuple[float, str | _core.TerrainAnswer]  # a stamp [s], and the surface by name or what a sensor says


def pushed(
    learner: _core.MotionLearner, drive: tuple[PreparedRun, ...], cues: Sequence[Sequence[Cue]] = ()
) -> Iterator[float]:
    """Push all runs, piece by piece; yields the fraction done.

    Args:
        learner: what is given the measurements.
        drive: the runs, in the order of time.
        cues: of each run, when a label names the surface; the learner receives it at that time.
    """
    sources = source_names(run.run for run in drive) if learner.sources else ()
    for place, run in enumerate(drive):
        learner.start_run()
        said = dict(cues[place]) if place < len(cues) else {}
        edges = np.unique([*np.linspace(*run.run.span, STEPS + 1)[1:-1], *said])
        for k, since in enumerate([-np.inf, *edges.tolist()]):
            if since in said:
                _tell(learner, said[since])
            until = float(edges[k]) if k < len(edges) else np.inf
            learner.push(recording_of(run.run, since, until, sources))
            yield (place + (k + 1) / (len(edges) + 1)) / len(drive)
    learner.end_run()
    yield 1.0


def _tell(learner: _core.MotionLearner, surface: str | _core.TerrainAnswer) -> None:
    if isinstance(surface, str):
        learner.cue_surface(surface)
    else:
        learner.cue_terrain(surface)


def held_out_predictions(
    model: _core.LearnedModel, horizons: Sequence[float], drive: tuple[PreparedRun, ...] = ()
) -> tuple[tuple[Predictions, ...], tuple[Predictions, ...]]:
    """Return the predictions that were held against what was measured, and those of the kinematic baseline.

    Args:
        model: what a learner has learned.
        horizons: of its predictions [s].
        drive: the runs that were pushed, where they come from a log.
    """
    return predictions_of([each.columns() for each in model.held_out], horizons, drive)


def predictions_of(
    held_out: Sequence[_core.HeldOutColumns],
    horizons: Sequence[float],
    drive: tuple[PreparedRun, ...] = (),
) -> tuple[tuple[Predictions, ...], tuple[Predictions, ...]]:
    """Return predictions that were held against what was measured, and the kinematic baseline's beside them.

    Args:
        held_out: predictions of each horizon, in order.
        horizons: theirs [s].
        drive: the runs that were pushed, where they come from a log.
    """
    learned = tuple(
        _predictions(horizon, columns, drive) for horizon, columns in zip(horizons, held_out, strict=True)
    )
    return learned, tuple(_baseline(own, columns) for own, columns in zip(learned, held_out, strict=True))


def _predictions(
    horizon: float, columns: _core.HeldOutColumns, drive: tuple[PreparedRun, ...]
) -> Predictions:
    run, learned_until = columns.run, columns.learned_until
    if drive and len(run):
        first = np.array([min(float(each.inputs.t[0]), each.begin) for each in drive])
        learned_until = np.maximum(np.minimum(first[run], columns.start), learned_until)
        run = np.array([each.index for each in drive], dtype=np.int64)[run]
    return Predictions(
        method="learned",
        horizon=horizon,
        run=run,
        t_start=columns.start,
        t_end=columns.end,
        pose=columns.pose,
        covariance=columns.covariance.reshape(-1, 3, 3),
        inflation=columns.inflation,
        dof=columns.dof,
        nominal_nis=columns.nominal_nis,
        structure=columns.structure,
        measured=columns.measured,
        learned_until=learned_until,
        in_sample=_errors(columns.measured, columns.in_sample),
    )


def _baseline(own: Predictions, columns: _core.HeldOutColumns) -> Predictions:
    """The kinematic baseline at the same segments, of which only the errors are asked."""
    return replace(
        own,
        method="none",
        pose=columns.baseline,
        in_sample=_errors(columns.measured, columns.baseline),
        learned_until=own.t_start,
    )


def _errors(measured: Floats, predicted: Floats) -> Floats:
    """Position [m] and heading [rad] errors, [N, 2]."""
    left = residual(measured, predicted)
    return np.column_stack((np.hypot(left[:, 0], left[:, 1]), np.abs(left[:, 2])))


def _history(
    events: Sequence[_core.LearnerEvent],
    last: _core.MotionPosterior,
    bases: tuple[str, ...],
    drive: tuple[PreparedRun, ...],
    *,
    several: bool,
) -> History:
    """The course of the structure that is kept in the end; NaN for segments before it was tried."""
    kept = last.structure
    names = tuple(info.name for info in last.model.parameters)
    mean, std = np.full((len(events), len(names)), np.nan), np.full((len(events), len(names)), np.nan)
    basis_weight = np.zeros((len(events), len(bases)))
    for i, event in enumerate(events):
        posterior = event.posterior(kept)
        if posterior is not None:
            mean[i] = posterior.estimate.mean
            std[i] = np.sqrt(np.diag(posterior.estimate.covariance))
            basis_weight[i] = posterior.basis_weights
    updates = [event.updates[kept] for event in events]
    run, alarm = [drive[event.run].index for event in events], [update.change.alarm for update in updates]
    return History(
        run=np.array(run, dtype=np.int64),
        t=np.array([event.t for event in events]),
        names=names,
        mean=mean,
        std=std,
        nis=np.array([update.nis for update in updates]),
        weight=np.array([update.weight for update in updates]),
        bases=bases,
        basis_weight=basis_weight,
        change=np.array([update.change.log_odds for update in updates]),
        alarm=np.array(alarm, dtype=np.bool_),
        structures=STRUCTURES if several else (),
        structure_weight=np.array([event.weights for event in events]) if several else None,
        surfaces=course_of(events, run, alarm),
    )


def measured_body(model: _core.LearnedModel) -> MeasuredBody:
    """Return what the learner measured beside what it learned."""
    rates = model.rates
    backward, forward = rates.speed
    right, left = rates.yaw_rate
    return MeasuredBody(
        speed=[0.0 - backward, forward],
        yaw_rate=[0.0 - right, left],
        acceleration=list(rates.acceleration),
        yaw_acceleration=list(rates.turning),
        held=list(model.held),
        seconds=rates.seconds,
    )

# SPDX-License-Identifier: Apache-2.0
"""A sequence of logs of one robot, replayed in its order with the surfaces that it remembers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from slipwise.calibration.learned_sequence import LearnedSequence, SequenceOptions, go_on, learn_sequence
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import PreparedRun, choose_input, prepare_run
from slipwise.calibration.same_log import learned_from, refuse_same_log
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import LogError, SettingsError
from slipwise.evaluation.evaluate import EvaluationOptions, Report, evaluate
from slipwise.evaluation.methods import method_info
from slipwise.evaluation.result import Evaluation
from slipwise.logs.log import Log
from slipwise.logs.open_log import joined

REMEMBERING = "auto"  # the method that is given a memory
FIRST = 10  # windows that tell how soon a surface is known


@dataclass(frozen=True)
class VisitScore:
    """One log of a sequence at the longest horizon: mean errors, and those of others.

    Others are the kinematic baseline, and the same learner that goes on from log to log without a memory;
    not a number where the sequence begins with a model, which that one cannot.
    """

    log: str
    surface: str  # on which it ended
    windows: int
    position: float  # m, of all windows
    heading: float  # rad
    first_position: float  # m, of the first ten windows
    first_heading: float  # rad
    baseline_position: float  # m, of all windows
    baseline_heading: float  # rad
    going_on_position: float  # m, of all windows
    going_on_heading: float  # rad
    going_on_first_position: float  # m, of the first ten windows
    going_on_first_heading: float  # rad


@dataclass(frozen=True, eq=False)
class SequenceEvaluation:
    """The logs of a sequence, each evaluated, and what was remembered in the end."""

    evaluations: tuple[Evaluation, ...]
    learned: LearnedSequence
    names: tuple[str, ...]  # of the logs
    went_on: tuple[tuple[Predictions, ...], ...] = ()  # of each log, by the learner without a memory

    def visits(self) -> tuple[VisitScore, ...]:
        """Score each log at its longest horizon."""
        others = self.went_on or ((),) * len(self.names)
        visited = zip(self.names, self.evaluations, self.learned.logs, others, strict=True)
        return tuple(_visit(name, each, log.surface, went_on) for name, each, log, went_on in visited)

    @property
    def causal(self) -> tuple[bool, ...]:
        """Of each log, whether its predictions are causal: the model to begin with has not learned it."""
        return tuple(each.score(REMEMBERING, max(each.horizons)).causal for each in self.evaluations)

    @property
    def good(self) -> bool:
        """Whether all logs together are predicted better than by the baseline."""
        visits = self.visits()

        def total(name: str) -> float:
            return float(sum(visit.windows * getattr(visit, name) for visit in visits))

        return total("position") < total("baseline_position") and total("heading") < total("baseline_heading")

    @property
    def gain(self) -> tuple[float, float] | None:
        """Errors of position and heading with the memory over those of going on without, of all windows."""
        visits = self.visits()
        found = []
        for name in ("position", "heading"):
            own, other = (
                sum(visit.windows * getattr(visit, part) for visit in visits)
                for part in (name, f"going_on_{name}")
            )
            found.append(own / other if other > 0.0 else math.nan)
        return None if any(map(math.isnan, found)) else (found[0], found[1])


def evaluate_sequence(
    logs: Sequence[tuple[str, Log]],
    *,
    input: str | None = None,
    settings: Settings | None = None,
    options: EvaluationOptions | None = None,
    progress: Report | None = None,
) -> SequenceEvaluation:
    """Evaluate logs one after the other; the method `auto` remembers the surfaces of those before.

    Other methods start from nothing in each log. Without methods, `none` and `auto` are compared.

    Args:
        logs: names and logs, in the order of time.
        input: "command" or "wheel"; without it, what the first log has.
        settings: what to learn and how.
        options: methods, horizons, and what the memory begins with.
        progress: called with what is done, and the fraction.

    Raises:
        LogError: a log has no such input, no poses, or no window of any horizon, or two are the same drive.
        SettingsError: a method, a basis or a horizon is wrong, or `auto` is not among the methods.
        ModelError: the model to begin with has another input, or no memory of surfaces.
    """
    settings, options = settings or Settings(), options or EvaluationOptions()
    methods = options.methods or ("none", REMEMBERING)
    if REMEMBERING not in methods:
        raise SettingsError(
            f"only the method {REMEMBERING} has a memory",
            where="--memory",
            advice=f"add {REMEMBERING} to --methods",
        )
    for name in methods:
        method_info(name, options.models)
    if not logs:
        raise LogError("a sequence needs a log", where="--memory", advice="give logs in the order of time")
    refuse_same_log(joined([log for _, log in logs]))
    memory = options.memory or SequenceOptions()
    input_name = choose_input(logs[0][1], input or (memory.start.content.input if memory.start else None))
    drives = [prepare_run(log, input_name) for _, log in logs]
    horizons = sorted(set(options.horizons))
    remembering = settings.model_copy(update={"basis": REMEMBERING, "estimator": AVERAGE})
    chosen = remembering if memory.start else for_the_ground_of(logs[0][1], remembering)
    said = progress or _nobody
    learned = learn_sequence(
        drives,
        chosen,
        horizons,
        options=replace(memory, embargo=options.embargo),
        progress=lambda done: said("memory", done),
    )
    went_on: tuple[tuple[Predictions, ...], ...] = ()
    if memory.start is None:
        went_on = go_on(
            drives, chosen, horizons, embargo=options.embargo, progress=lambda done: said("going on", done)
        )
    evaluations = []
    for (_, log), drive, visited in zip(logs, drives, learned.logs, strict=True):
        made = {REMEMBERING: visited.predictions}
        if memory.start is not None and learned_from(log, memory.start):
            made = {REMEMBERING: tuple(_known_to_the_end(each, drive) for each in visited.predictions)}
        evaluations.append(
            evaluate(
                log,
                input=input_name,
                settings=settings,
                options=replace(options, methods=methods, made=made),
                progress=progress,
            )
        )
    return SequenceEvaluation(tuple(evaluations), learned, tuple(name for name, _ in logs), went_on)


def _known_to_the_end(predictions: Predictions, drive: Sequence[PreparedRun]) -> Predictions:
    """Say of predictions that all of their log was learned before: they are not causal."""
    ends = {run.index: run.end for run in drive}
    return replace(predictions, learned_until=np.array([ends[run] for run in predictions.run.tolist()]))


def _nobody(_name: str, _done: float) -> None:
    """Nobody watches."""


def _visit(name: str, evaluation: Evaluation, surface: str, went_on: tuple[Predictions, ...]) -> VisitScore:
    longest = {p.method: p for p in evaluation.predictions if p.horizon == max(evaluation.horizons)}
    own, baseline = longest[REMEMBERING], longest["none"]
    others = next((each for each in went_on if each.horizon == own.horizon), None)
    return VisitScore(
        log=name,
        surface=surface,
        windows=len(own),
        position=_mean(own.position_error),
        heading=_mean(own.heading_error),
        first_position=_mean(own.position_error[:FIRST]),
        first_heading=_mean(own.heading_error[:FIRST]),
        baseline_position=_mean(baseline.position_error),
        baseline_heading=_mean(baseline.heading_error),
        going_on_position=math.nan if others is None else _mean(others.position_error),
        going_on_heading=math.nan if others is None else _mean(others.heading_error),
        going_on_first_position=math.nan if others is None else _mean(others.position_error[:FIRST]),
        going_on_first_heading=math.nan if others is None else _mean(others.heading_error[:FIRST]),
    )


def _mean(errors: np.ndarray) -> float:
    return float(errors.mean()) if len(errors) else float("nan")

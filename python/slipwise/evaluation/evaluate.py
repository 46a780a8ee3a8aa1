# SPDX-License-Identifier: Apache-2.0
"""Honest comparison of methods on a log: prequential predictions with an embargo, second half scored."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from slipwise.calibration.calibrate import learning_windows, refuse_empty
from slipwise.calibration.learned_sequence import SequenceOptions
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import (
    WindowSet,
    choose_input,
    collect_windows,
    prepare_run,
    unused_runs,
)
from slipwise.calibration.same_log import learned_from
from slipwise.calibration.settings import Settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import LogError, SettingsError
from slipwise.evaluation.methods import Contest, method_info, method_names, refuse_names_of_methods
from slipwise.evaluation.result import Evaluation
from slipwise.evaluation.scoring import scores_of
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.log import Log, has_course
from slipwise.models.common_input import of_common_input
from slipwise.models.model import Model

DEFAULT_HORIZONS = (1.0, 2.0, 5.0)  # s
LONGEST_EMBARGO = 3600.0  # s
SHORTEST_HORIZON = 0.5  # s; what is driven in less is hardly more than the noise of the poses
Report = Callable[[str, float], None]


@dataclass(frozen=True)
class EvaluationOptions:
    """What to compare, and over which horizons."""

    horizons: tuple[float, ...] = DEFAULT_HORIZONS  # s
    methods: tuple[str, ...] | None = None  # None: all that apply; model files always are among them
    vendor_wheel_separation_multiplier: float | None = None
    model: Model | Mapping[str, Model] | None = None  # model files as they are: `model`, or several by name
    # What a calibration of this log with these settings predicted, by method: not learned a second time.
    made: Mapping[str, tuple[Predictions, ...]] = field(default_factory=dict)
    embargo: float | None = None  # s before a prediction from which nothing is learned; None: one horizon
    memory: SequenceOptions | None = None  # what a sequence of logs begins with, and labels of them

    @property
    def models(self) -> dict[str, Model]:
        """The model files by the names of their methods."""
        if self.model is None:
            return {}
        return {"model": self.model} if isinstance(self.model, Model) else dict(self.model)


def evaluate(
    log: Log,
    *,
    input: str | None = None,
    settings: Settings | None = None,
    options: EvaluationOptions | None = None,
    progress: Report | None = None,
) -> Evaluation:
    """Predict every window with every method from what was known before it, and score the second half.

    Raises:
        LogError: the log has no such input, no poses, or no window of any horizon.
        SettingsError: a method, a basis or a horizon is wrong.
    """
    settings, options = for_the_ground_of(log, settings or Settings()), options or EvaluationOptions()
    models = of_common_input(options.models, input)
    input_name, options = _input_name(log, input, models), replace(options, model=models)
    refuse_names_of_methods(models)
    contest, notes = contest_of(log, input_name, settings, options)
    methods = tuple(dict.fromkeys((*(options.methods or method_names(contest)), *models)))
    for name in methods:
        method_info(name, models)
    predictions: list[Predictions] = []
    for done, name in enumerate(methods):
        if progress is not None:
            progress(name, done / len(methods))
        made = _made(name, options, contest)
        predictions += made if made is not None else method_info(name, models).predict(name, contest)
    return Evaluation(
        input=input_name,
        horizons=tuple(targets.length for targets in contest.targets),
        methods=tuple(methods),
        scores=scores_of(predictions, _baseline(predictions, contest), contest.targets),
        predictions=tuple(predictions),
        runs=tuple(run.name for run in log.runs),
        left_out=(*log.left_out, *unused_runs(log, input_name), *contest.targets[-1].left_out),
        notes=log.notes + notes,
        contradictions=findings_of(
            log, input_name, settings.segment.unknown_after, sensor=settings.sensor_extrinsics.pose
        ),
        models=tuple(models),
        positions=has_course(log.runs),
        embargo=options.embargo,
        clocks_compared=log.clocks_compared,
    )


def _baseline(predictions: Sequence[Predictions], contest: Contest) -> dict[float, Predictions]:
    """Predictions of no slip by horizon, that ratios are relative to; made here where not asked for."""
    asked = [each for each in predictions if each.method == "none"]
    return {each.horizon: each for each in asked or method_info("none", {}).predict("none", contest)}


def _made(name: str, options: EvaluationOptions, contest: Contest) -> tuple[Predictions, ...] | None:
    """Return the predictions of a method that were made already, where all horizons are among them."""
    by_horizon = {each.horizon: replace(each, method=name) for each in options.made.get(name, ())}
    wanted = [targets.length for targets in contest.targets]
    return tuple(by_horizon[h] for h in wanted) if by_horizon.keys() >= set(wanted) else None


def _input_name(log: Log, input_name: str | None, models: Mapping[str, Model]) -> str:
    input_name = None if input_name is None else choose_input(log, input_name)
    for name, model in models.items():
        learned = model.content.input
        if input_name is not None and learned != input_name:
            raise SettingsError(
                f"{name} was learned from {learned} input, not {input_name}",
                where="--input",
                advice=f"use --input {learned}, and models that were learned from the same input",
            )
        input_name = learned
    return input_name or choose_input(log)


def contest_of(
    log: Log, input_name: str, settings: Settings, options: EvaluationOptions
) -> tuple[Contest, tuple[str, ...]]:
    """Return the windows that methods are asked for, and what to say of horizons that have none.

    Raises:
        LogError: the log has no such input, no poses, or no window of any horizon.
        SettingsError: a horizon or the embargo is wrong.
    """
    if not options.horizons or any(not (np.isfinite(h) and h > 0.0) for h in options.horizons):
        raise SettingsError("horizons must be positive seconds", where="--horizons", advice="such as 1,2,5")
    if options.embargo is not None and not 0.0 <= options.embargo <= LONGEST_EMBARGO:
        raise SettingsError(
            f"an embargo lasts from 0 to {LONGEST_EMBARGO:g} s", where="--embargo", advice="such as 0"
        )
    drive = prepare_run(log, input_name)
    windows = learning_windows(drive, input_name, settings)
    refuse_empty(windows, log)
    sets = [collect_windows(drive, horizon, settings.rules()) for horizon in sorted(set(options.horizons))]
    targets = tuple(item for item in sets if len(item) >= 2)
    notes = tuple(
        f"no prediction over {item.length:g} s: the log has {len(item)} such windows"
        for item in sets
        if len(item) < 2
    )
    notes += tuple(_read_otherwise(log, input_name, options))
    if not targets:
        raise LogError(
            "the log has no two windows of any horizon asked for",
            where=", ".join(source.path for source in log.sources[:3]),
            advice=_more_windows(sets),
        )
    learned_from_this = frozenset(name for name, model in options.models.items() if learned_from(log, model))
    contest = Contest(
        input_name,
        settings,
        windows,
        targets,
        options.vendor_wheel_separation_multiplier,
        options.models,
        learned_from_this,
        options.embargo,
    )
    return contest, notes


def _read_otherwise(log: Log, input_name: str, options: EvaluationOptions) -> Iterator[str]:
    """Say which models have learned inputs that were multiplied by other factors than those of the log."""
    scale = log.scales.get(input_name, (1.0, 1.0))
    for name, model in options.models.items():
        learned = tuple(model.content.provenance.input_scale or (1.0, 1.0))
        if learned != scale:
            (speed, turn), (own, own_turn) = learned, scale
            yield (
                f"{name} has learned inputs times {speed:g} and {turn:g}, and those of this log are times "
                f"{own:g} and {own_turn:g}: give the same --{input_name}-scale"
            )


def _more_windows(sets: Sequence[WindowSet]) -> str:
    """What would give windows: shorter horizons where these are long, else what was rejected."""
    rejected = "; ".join(f"{item.count} x {item.reason}" for item in sets[0].left_out)
    if sets[0].length > SHORTEST_HORIZON:
        return (
            f"ask for shorter --horizons, such as {SHORTEST_HORIZON:g}{f' ({rejected})' if rejected else ''}"
        )
    return rejected or f"it needs poses and inputs together for {4.0 * sets[0].length:g} s at least"

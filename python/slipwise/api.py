# SPDX-License-Identifier: Apache-2.0
"""What `import slipwise` offers to Python: the functions of the layers below, which take paths too."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

from numpy.typing import ArrayLike

from slipwise import _core, calibration, evaluation, prediction
from slipwise.argument_types import check_arguments
from slipwise.calibration import Settings
from slipwise.calibration.both_inputs import calibrate_inputs
from slipwise.evaluation import Evaluation, EvaluationOptions, ModelComparison, compare_models
from slipwise.ground import Ground, Pose
from slipwise.logs import Inputs, Log, open_log
from slipwise.models import Model, load_model
from slipwise.terrain_ahead import TerrainAhead

LogOrPath = Log | str | Path | Sequence[str | Path]
ModelOrPath = Model | str | Path


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Calibration(calibration.Calibration):
    """What was learned, with the log and the settings, so that a report can be written of it."""

    log: Log
    settings: Settings

    def report(self, path: str | Path) -> Path:
        """Write the HTML report, one file that works offline; return its path.

        Raises:
            OutputError: the file cannot be written.
            SettingsError: this is no path.
        """
        check_arguments(Calibration.report, locals())
        from slipwise.reporting.session import report_calibration

        report_calibration(Path(path), self.log, self, self.settings)
        return Path(path)


def calibrate(  # noqa: PLR0913 - options, most of them short for a setting
    log: LogOrPath,
    *,
    basis: str | None = None,
    input: str | None = None,
    settings: Settings | None = None,
    estimator: str | None = None,
    smooth: bool = False,
) -> Calibration:
    """Learn the motion model of the robot in `log`; see `slipwise.calibration.both_inputs`.

    Args:
        log: what `open_log` returned, or what it takes: a path, or several.
        basis: "auto" or a named basis; short for `settings` with that basis.
        input: "command" or "wheel"; by default both where the log has both: the model is of commands, and
            `model.of_input("wheel")` answers from wheel speeds.
        settings: what to learn and how.
        estimator: "average", or of the package slipwise-thesis "iekf", "delayed-state", "ekf-thesis",
            "gradient-descent", or "batch", which fits all windows at once, off-line; short for
            `settings` with that estimator.
        smooth: also say what the slip was during each window, given the whole log.

    Raises:
        LogError: the log cannot be read, has no such input, no poses, or no window to learn from.
        SettingsError: the basis or the estimator is unknown.
    """
    check_arguments(calibrate, locals())
    chosen, opened = (settings or Settings()).choosing(basis, estimator), _opened(log)
    learned = calibrate_inputs(opened, input=input, settings=chosen, smooth=smooth)
    parts = {field.name: getattr(learned, field.name) for field in fields(learned)}
    return Calibration(**parts, log=opened, settings=chosen)


def evaluate(  # noqa: PLR0913 - all but the log are options
    log: LogOrPath,
    *,
    model: ModelOrPath | None = None,
    input: str | None = None,
    settings: Settings | None = None,
    options: EvaluationOptions | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Evaluation:
    """Predict every window with every method from what was known before it, and score the second half.

    Args:
        log: what `open_log` returned, or what it takes: a path, or several.
        model: a model to judge too, or its file; short for `options` with that model.
        input: "command" or "wheel"; by default that of the model, or commands where the log has them.
        settings: how the methods learn.
        options: what to compare, and over which horizons.
        progress: called with the method at work and the fraction done, 0 to 1.

    Raises:
        LogError: the log cannot be read, has no such input, no poses, or no window of any horizon.
        ModelError: the file is no model.
        SettingsError: a method, a basis or a horizon is wrong.
    """
    check_arguments(evaluate, locals())
    options = options or EvaluationOptions()
    if model is not None:
        options = replace(options, model=_loaded(model))
    return evaluation.evaluate(
        _opened(log), input=input, settings=settings, options=options, progress=progress
    )


def compare(old: ModelOrPath, new: ModelOrPath, log: LogOrPath) -> ModelComparison:
    """Say whether a new model predicts the robot of a log better than an old one, with 95 % intervals.

    Args:
        old: the model in force, or where its file is.
        new: the one that may take its place.
        log: what `open_log` returned, or what it takes: a path, or several. Best one of neither's logs.

    Raises:
        LogError: the log cannot be read, has no such input, no poses, or no window.
        ModelError: a file is no model.
        SettingsError: the models were learned from different inputs.
    """
    check_arguments(compare, locals())
    return compare_models(("old", _loaded(old)), ("new", _loaded(new)), _opened(log))


def predict(  # noqa: PLR0913 - all but the first two are options
    model: ModelOrPath,
    commands: Inputs | ArrayLike,
    *,
    horizon: float,
    start: float | None = None,
    initial: tuple[float, ...] | None = None,
    slip_now: _core.SlipNow | None = None,
    ground: Ground | None = None,
    at: Pose = (0.0, 0.0, 0.0),
    terrain_ahead: TerrainAhead | None = None,
    force_age: float = 0.0,
    known_force: tuple[float, float] = (0.0, 0.0),
    input: str | None = None,
) -> prediction.Path:
    """Predict the path of base_link under `commands`; see `slipwise.prediction.predict`.

    Args:
        model: a learned model, or its file.
        commands: rows of (t [s], v [m/s], omega [rad/s]), each held until the next, [N, 3], or `Inputs`; of a
            robot that drives sideways (t, v, vy, omega), of a car (t, throttle, steering).
        horizon: how far to predict [s].
        start: when the prediction starts [s]; by default at the first command.
        initial: the measured (v [m/s], omega [rad/s]), or (v, vy, omega), at the start.
        slip_now: where slip is at the start, as `slipwise.prediction.slip_seen` says.
        ground: a `Grade` or an `ElevationMap` of `slipwise.ground`; level by default.
        at: the robot's pose (x, y [m], yaw [rad]) at the start in the frame of the ground.
        terrain_ahead: surfaces along the path, a `TerrainAhead` of `slipwise.terrain_ahead`.
        force_age: how long ago the model was learned [s], where a force was learned beside slip.
        known_force: what pushes the robot, over its mass, ahead and to its left [m/s^2].
        input: what `commands` are, "command" or "wheel" speeds, where the model answers from both; commands
            by default.

    Raises:
        ModelError: the file is no model, or the model does not remember a surface ahead.
        SettingsError: the horizon is not positive, the start lies before the first command, the commands are
            not such rows, or the path leaves the map of elevations.
    """
    check_arguments(predict, locals())
    return prediction.predict(
        _loaded(model),
        commands,
        horizon=horizon,
        start=start,
        initial=initial,
        slip_now=slip_now,
        ground=ground,
        at=at,
        terrain_ahead=terrain_ahead,
        force_age=force_age,
        known_force=known_force,
        input=input,
    )


def _opened(log: LogOrPath) -> Log:
    if isinstance(log, Log):
        return log
    return open_log(log) if isinstance(log, str | Path) else open_log(*log)


def _loaded(model: ModelOrPath) -> Model:
    return model if isinstance(model, Model) else load_model(model)

# SPDX-License-Identifier: Apache-2.0
"""The measured, plain and predicted path of one window, seen from the robot at its start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.calibration.settings import sensor_of
from slipwise.logs.log import Floats, Poses, Run
from slipwise.prediction import asked_twists
from slipwise.reporting.chosen_windows import ChosenWindow
from slipwise.reporting.contents import Contents
from slipwise.segments import WindowRules, cut_windows


@dataclass(frozen=True, eq=False)
class WindowPaths:
    """Paths of one window, [N, 3] each: x, y [m], yaw [rad] in the frame of the robot at the start."""

    measured: Floats
    plain: Floats
    predicted: Floats
    causal: bool  # the prediction uses what was known at the start, not the final model


def window_paths(contents: Contents, chosen: Sequence[ChosenWindow]) -> dict[ChosenWindow, WindowPaths]:
    """Return the paths of the chosen windows, without those whose poses or inputs are not in the log."""
    paths = {}
    for place in sorted({window.run for window in chosen if 0 <= window.run < len(contents.log.runs)}):
        run = contents.log.runs[place]
        inputs = contents.inputs(run)
        if inputs is None:
            continue
        history = asked_twists(contents.calibration.model, inputs)
        limited = contents.calibration.model.driven(history)
        segments = _segments(contents, run)
        for window in (window for window in chosen if window.run == place):
            measured = _measured(run.poses, window)
            if measured is not None:
                segment = segments.get(_stamp(window.t_start)) or _level_segment(
                    window, sensor_of(contents.calibration.model)
                )
                paths[window] = _paths(contents, window, _Drive(history, limited, segment, measured))
    return paths


@dataclass(frozen=True, eq=False)
class _Drive:
    """Results of one window."""

    history: _core.InputHistory
    limited: _core.InputHistory  # what the model's limits leave of it
    segment: _core.Segment
    measured: Floats


def _paths(contents: Contents, window: ChosenWindow, drive: _Drive) -> WindowPaths:
    model = contents.calibration.model
    baseline_model = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    # Of a car's curves only the last are known here.
    known = None if model.car is not None else _known_parameters(contents, window)
    parameters = model.mean if known is None else known
    return WindowPaths(
        measured=drive.measured,
        plain=_sensor_path(baseline_model, np.empty(0), drive.history, drive.segment),
        predicted=_sensor_path(model.motion, parameters, drive.limited, drive.segment),
        causal=known is not None,
    )


def _sensor_path(
    motion: _core.MotionModel, parameters: Floats, history: _core.InputHistory, segment: _core.Segment
) -> Floats:
    """Return the path of what measures it, [N, 3]."""
    exact = _core.Integrator.Exact
    return _core.integrate_segment(motion, parameters, history, segment, exact).sensor_poses


def _measured(poses: Poses, window: ChosenWindow) -> Floats | None:
    """Return the measured poses seen from the first of the window, None without two in one frame."""
    inside = (poses.t >= window.t_start - _core.SAME_STAMP) & (poses.t <= window.t_end + _core.SAME_STAMP)
    rows = np.flatnonzero(inside)
    if len(rows) < 2 or poses.frame[rows[0]] != poses.frame[rows[-1]]:
        return None
    start = _core.Pose2(float(poses.x[rows[0]]), float(poses.y[rows[0]]), float(poses.yaw[rows[0]]))
    seen = [
        _core.between(start, _core.Pose2(float(poses.x[k]), float(poses.y[k]), float(poses.yaw[k]))).vector()
        for k in rows
    ]
    return np.array(seen)


def _segments(contents: Contents, run: Run) -> dict[int, _core.Segment]:
    """Return the run's windows by start, with gravity and twist there, as the evaluation cuts them."""
    horizon = contents.longest_horizon
    if horizon is None:
        return {}
    rules = WindowRules(sensor=sensor_of(contents.calibration.model))
    from_commands = contents.evaluation.input == "command"
    windows = cut_windows([run], rules.stream_settings(horizon, from_commands=from_commands))
    stamps = (_stamp(start) for start in windows.start.tolist())
    return {stamp: segment.foreseen() for stamp, segment in zip(stamps, windows.segments, strict=True)}


def _stamp(t: float) -> int:
    """Return a time [s] as whole microseconds, to look it up."""
    return round(t * 1e6)


def _level_segment(window: ChosenWindow, sensor: tuple[float, float, float]) -> _core.Segment:
    level = _core.Segment(window.t_start, window.t_end, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    return level.with_sensor(_core.Pose2(*sensor))


def _known_parameters(contents: Contents, window: ChosenWindow) -> Floats | None:
    """Return the parameters learned until an embargo before the start, None where that is not recorded."""
    history, model = contents.calibration.history, contents.calibration.model
    if history is None or list(history.names) != model.vector.names:
        return None
    embargo = contents.evaluation.embargo
    before = (contents.longest_horizon or 0.0) if embargo is None else embargo
    until = window.t_start - before + _core.SAME_STAMP
    learned = np.flatnonzero(
        (history.run < window.run) | ((history.run == window.run) & (history.t <= until))
    )
    if not len(learned) or not np.isfinite(history.mean[learned[-1]]).all():
        return None
    return np.ascontiguousarray(history.mean[learned[-1]])

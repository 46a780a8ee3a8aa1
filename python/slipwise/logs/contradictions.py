# SPDX-License-Identifier: Apache-2.0
"""All that shows poses and inputs of a log to contradict each other, for the input that is learned from."""

from __future__ import annotations

from slipwise.logs.command_timeout import REPEAT, silent_commands, stops_after
from slipwise.logs.contradiction import Contradiction
from slipwise.logs.course_heading import course_heading
from slipwise.logs.driven_windows import driven_windows
from slipwise.logs.gyro import gyro_contradictions
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, Log, Run, has_course
from slipwise.logs.motion_windows import MotionWindows, motion_windows
from slipwise.logs.repeated_wheels import repeated_wheels
from slipwise.logs.standstill import standstill
from slipwise.logs.turned_poses import COMMANDS, WHEELS, lost_heading, turned_heading, unlikely_speed

_CAUSES = {"command": "it is commanded", "wheel": "its wheels turn"}


def contradictions(
    log: Log, input_name: str, unknown_after: float = UNKNOWN_AFTER, *, sensor_yaw: float = 0.0
) -> tuple[Contradiction, ...]:
    """Return what shows that poses and inputs cannot both be right.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel", what is learned from.
        unknown_after: an input is unknown once it is older than this [s].
        sensor_yaw: how the pose sensor is known to be turned on the robot [rad].
    """
    windows = _windows(log, input_name, unknown_after)
    driven = driven_windows(windows, sensor_yaw)
    words = COMMANDS if input_name == "command" else WHEELS
    speed = unlikely_speed(driven, words)
    still = None if speed is not None else standstill(windows, _starts(log, input_name), _CAUSES[input_name])
    found = [speed, still, *gyro_contradictions(log.runs)]
    headed = not has_course(log.runs)  # a course tells nothing of a heading
    if headed and (still is None or not still.spoils):
        other = "wheel" if input_name == "command" else "command"
        others = driven_windows(_windows(log, other, unknown_after), sensor_yaw)
        alone = others.direction.real > 0.5
        course = course_heading(windows, sensor_yaw)
        found.append(course)
        if course is None:  # what else a heading seems to do would come from it
            found.append(turned_heading(driven, words, alone=alone))
            found.append(lost_heading(windows, driven, words))
    if input_name == "command":
        found.append(_ended_commands(log, unknown_after))
    found.append(repeated_wheels([(inputs, run.poses) for run, inputs in _with(log, "wheel")]))
    return tuple(each for each in found if each is not None)


def _ended_commands(log: Log, unknown_after: float) -> Contradiction | None:
    """Say where the robot stops between commands that are taken to be held."""
    pairs = [(inputs, run.poses) for run, inputs in _with(log, "command")]
    stop = stops_after(pairs)
    if stop is None or stop + REPEAT > unknown_after:
        return None
    sentence, advice = silent_commands(pairs, unknown_after) or ("", "")
    return Contradiction("command-timeout", sentence, (advice,)) if sentence else None


def _windows(log: Log, input_name: str, unknown_after: float) -> MotionWindows:
    return motion_windows([(inputs, run.poses) for run, inputs in _with(log, input_name)], unknown_after)


def _starts(log: Log, input_name: str) -> tuple[tuple[str, float], ...]:
    return tuple(
        (run.name, float(run.poses.t[0]) if len(run.poses) else 0.0) for run, _ in _with(log, input_name)
    )


def _with(log: Log, input_name: str) -> list[tuple[Run, Inputs]]:
    """Return the runs that have such inputs, with them."""
    found = []
    for run in log.runs:
        inputs = run.commands if input_name == "command" else run.wheels
        if inputs is not None and len(inputs):
            found.append((run, inputs))
    return found

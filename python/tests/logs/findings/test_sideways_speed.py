# SPDX-License-Identifier: Apache-2.0
"""Sideways speeds that a robot with mecanum wheels does not move by are named, and sound ones are not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, dead_reckoned, sound_log
from faulty_logs import rotated_into_parent

from slipwise.logs import Inputs, Log
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.log import Floats

Change = Callable[[Inputs], Inputs]


def mecanum_log() -> Log:
    """Wheels of a robot that moves 95 % of what they say ahead, 85 % sideways and 60 % of the yaw rate."""
    sound = sound_log(replace(SKID_STEERED, seconds=150.0))
    (run,) = sound.runs
    assert run.wheels is not None
    w, rng = run.wheels, np.random.default_rng(4)
    vy = np.repeat(rng.uniform(-0.9, 0.9, len(w) // 40 + 1), 40)[: len(w)]
    wheels = replace(w, vy=vy)
    poses = dead_reckoned(replace(w, v=0.95 * w.v, vy=0.85 * vy, omega=0.6 * w.omega))
    x, y = (each + 0.005 * rng.standard_normal(len(poses)) for each in (poses.x, poses.y))
    return replace(sound, runs=(replace(run, commands=None, wheels=wheels, poses=replace(poses, x=x, y=y)),))


MECANUM = mecanum_log()


def with_wheels(change: Change) -> Log:
    (run,) = MECANUM.runs
    assert run.wheels is not None
    return replace(MECANUM, runs=(replace(run, wheels=change(run.wheels)),))


def sideways(change: Callable[[Floats], Floats]) -> Change:
    return lambda w: replace(w, vy=change(w.vy))


FAULTS: dict[str, tuple[Change, str]] = {
    "to the right": (sideways(np.negative), "the sign of the sideways speed is flipped"),
    "backwards": (lambda w: replace(w, v=-w.v), "the sign of the forward speed is flipped"),
    "swapped": (lambda w: replace(w, v=w.vy, vy=w.v), "both speeds are swapped"),
    "without its sign": (sideways(np.abs), "the sideways speed lost its sign"),
    "in cm/s": (sideways(lambda vy: 100.0 * vy), "the sideways speed is in another unit"),
    "in km/s": (sideways(lambda vy: 0.001 * vy), "the sideways speed is in another unit"),
    "the yaw rate": (lambda w: replace(w, vy=w.omega, omega=w.vy), "turn as these move to the left"),
    "not there": (sideways(np.zeros_like), "no sideways speed of the wheels tells of"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_sideways_speed_that_poses_do_not_follow_is_named(name: str) -> None:
    change, what = FAULTS[name]
    found = [each for each in findings_of(with_wheels(change), "wheel") if each.spoils]
    assert [each.kind for each in found] == ["sideways-speed"]
    assert what in found[0].sentence


def test_a_robot_that_slips_sideways_is_none() -> None:
    assert findings_of(MECANUM, "wheel") == ()
    assert findings_of(with_wheels(sideways(lambda vy: 0.5 * vy)), "wheel") == ()


def test_commands_in_the_frame_of_the_map_are_found() -> None:
    (run,) = MECANUM.runs
    turned = rotated_into_parent(run)
    commanded = replace(MECANUM, runs=(replace(turned, commands=turned.wheels, wheels=None),))
    found = [each for each in findings_of(commanded, "command") if each.spoils]
    assert [each.kind for each in found] == ["parent-twist"]
    assert found[0].sentence.startswith("the direction of the speed of the commands is that in the world")

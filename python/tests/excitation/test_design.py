# SPDX-License-Identifier: Apache-2.0
"""A designed drive keeps limits and area, is closed and mirrored, and teaches more than uniform commands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from excitation.samples import OPTIONS, SPACE, small_drive

from slipwise.errors import PlanningError, SettingsError
from slipwise.excitation import (
    CommandSpace,
    ExcitationOptions,
    Move,
    design_drive,
    drawn_robots,
    lessons_of,
    prior_knowledge,
)
from slipwise.excitation.moves import command_periods


def test_drive_keeps_time_and_limits() -> None:
    drive = small_drive()
    assert drive.seconds <= 60.0 * OPTIONS.minutes
    assert len(drive.moves) in (8, 16)
    for move in drive.moves:
        assert abs(move.v) <= SPACE.speed
        assert abs(move.omega) <= SPACE.yaw_rate


def test_drive_is_closed_and_mirrored() -> None:
    told = sorted((move.v, move.omega) for move in small_drive().moves)
    assert told == sorted((-v, -w) for v, w in told)
    assert told == sorted((v, -w) for v, w in told)


def test_thousand_likely_robots_stay_inside_the_area() -> None:
    drive = small_drive()
    box = drawn_robots(drive.knowledge, 1000, seed=77).box(command_periods(drive.moves, 0.1))
    x, y = drive.start
    assert x + box[0] - OPTIONS.radius >= 0.0
    assert x + box[1] + OPTIONS.radius <= 8.0
    assert y + box[2] - OPTIONS.radius >= 0.0
    assert y + box[3] + OPTIONS.radius <= 7.0


def test_lateral_limit_is_kept() -> None:
    space = CommandSpace(1.0, 1.0, 0.3)
    drive = design_drive(prior_knowledge(space), space, replace(OPTIONS, area=(30.0, 30.0)))
    assert max(abs(move.v * move.omega) for move in drive.moves) <= 0.3 + 1e-9


def test_same_seed_gives_the_same_drive() -> None:
    again = design_drive(prior_knowledge(SPACE), SPACE, OPTIONS)
    assert again.moves == small_drive().moves


def test_drive_without_an_area_teaches_more_than_uniform_commands() -> None:
    space = CommandSpace(3.0, 2.0, 4.0)
    knowledge = prior_knowledge(space, dynamics=False)
    options = ExcitationOptions(area=None, pause=0.0, minutes=0.3)
    drive = design_drive(knowledge, space, options)
    ours = lessons_of(drive)[-1].yaw
    random = np.random.default_rng(4)
    commands = space.grid(9)
    theirs = []
    for _ in range(20):
        chosen = commands[random.integers(len(commands), size=len(drive.moves))]
        moves = tuple(Move(v, w, 2.0, 0.0) for v, _, w in chosen.tolist())
        theirs.append(lessons_of(replace(drive, moves=moves))[-1].yaw)
    assert ours < 0.5 * np.median(theirs)


def test_too_little_time_is_refused_with_the_least() -> None:
    with pytest.raises(SettingsError, match=r"give 0\.18 or more"):
        design_drive(prior_knowledge(SPACE), SPACE, replace(OPTIONS, minutes=0.1))


def test_area_without_room_is_refused() -> None:
    with pytest.raises(PlanningError, match="larger area"):
        design_drive(prior_knowledge(SPACE), SPACE, replace(OPTIONS, area=(1.01, 1.01)))


def test_option_that_makes_no_sense_is_refused(subtests: pytest.Subtests) -> None:
    for wrong in [
        {"minutes": 0.0},
        {"hold": 0.25},
        {"pause": -0.1},
        {"radius": -1.0},
        {"area": (0.0, 8.0)},
        {"minutes": float("nan")},
    ]:
        with subtests.test(wrong=wrong), pytest.raises(SettingsError):
            replace(OPTIONS, **wrong)  # type: ignore[arg-type]

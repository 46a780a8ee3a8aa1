# SPDX-License-Identifier: Apache-2.0
"""Moves worth driving are asked of a robot as it was driven: no faster, no tighter, and not in reverse."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from functools import cache

import numpy as np
from scripted_node import SLIP, driven, run_node

from slipwise.calibration.live_table import LiveTable
from slipwise.live.move_adviser import LOOK_EVERY, MoveAdviser, Turning
from slipwise.live.outputs import NextMovesNow
from slipwise.live.samples import Command, Sample, Wheels
from slipwise.models import Model

SHORT = replace(SLIP, seconds=25.0)


def turned(curvature: float) -> Turning:
    turning = Turning()
    turning.take(Wheels(0.0, 1.0, curvature))
    return turning


def moves_of(script: list[Sample], **live: object) -> tuple[list[NextMovesNow], Model | None]:
    built, transport = run_node(script, LiveTable(**live))  # type: ignore[arg-type]
    return [each for each in transport.outputs if isinstance(each, NextMovesNow)], built.learning.model


@cache
def learned_model() -> Model:
    model = moves_of(driven(SHORT))[1]
    assert model is not None
    return model


def commands_of(adviser: MoveAdviser, model: Model) -> tuple[np.ndarray, np.ndarray, NextMovesNow]:
    found = adviser.advance(1.0, model, (), whole=True)
    assert found is not None
    v, omega = np.array([(move.v, move.omega) for move in found.moves]).reshape(-1, 2).T
    return v, omega, found


def test_a_node_gives_three_moves_within_the_speeds_it_saw_and_a_bar_for_every_parameter() -> None:
    script = driven(SHORT)
    twists = [sample for sample in script if isinstance(sample, Wheels)]
    found, model = moves_of(script)
    assert model is not None
    last = found[-1]
    assert len(last.moves) == 3
    assert max(abs(move.v) for move in last.moves) <= max(abs(each.v) for each in twists) * 1.001
    assert max(abs(move.omega) for move in last.moves) <= max(abs(each.omega) for each in twists) * 1.001
    assert [each.name for each in last.parameters] == list(model.parameters)
    assert all((each.known == 1.0) == model.parameters[each.name].identified for each in last.parameters)
    yaw, position = last.predictions
    assert yaw.std < yaw.prior_std
    assert position.std < position.prior_std
    stds = [yaw.std, *(move.yaw_std for move in last.moves)]
    assert stds == sorted(stds, reverse=True)


def test_a_robot_that_turned_in_wide_curves_alone_is_asked_for_no_tighter_one() -> None:
    model = learned_model()
    v, omega, _ = commands_of(MoveAdviser(reverse=True, turning=turned(0.4)), model)
    assert (np.abs(omega) <= 0.4 * np.maximum(np.abs(v), 0.05) * 1.01).all()
    assert len(v) == 3


def test_what_is_not_learned_is_not_asked_for() -> None:
    v, _, _ = commands_of(MoveAdviser(reverse=False, turning=turned(5.0)), learned_model())
    assert (v >= 0.0).all()


def test_a_robot_that_was_never_driven_backwards_is_asked_for_the_slowest_speed_there() -> None:
    content = learned_model().content
    fastest = max(map(abs, content.range.speed))
    forwards = content.range.model_copy(update={"speed": (0.0, fastest)})
    model = Model(content.model_copy(update={"range": forwards}))
    v, _, _ = commands_of(MoveAdviser(reverse=True, turning=turned(5.0)), model)
    assert (v >= -0.26 * fastest).all()
    assert len(v) == 3


def test_before_the_robot_turned_it_is_said_what_to_do() -> None:
    adviser = MoveAdviser(reverse=True, turning=Turning())
    _, _, found = commands_of(adviser, learned_model())
    assert found.moves == ()
    assert "slow curve" in found.why


def test_a_command_that_is_no_number_is_no_turn() -> None:
    turning = Turning()
    for omega in (math.nan, math.inf, 0.05):
        turning.take(Command(0.0, 1.0, omega))
    assert turning.curvature == 0.0


def test_it_looks_once_for_a_model_and_not_again_before_its_time() -> None:
    model = learned_model()
    adviser = MoveAdviser(reverse=True, turning=turned(5.0))
    now = time.monotonic()
    assert not adviser.due(None, now)
    assert adviser.due(model, now)
    pieces = 0
    while adviser.advance(1.0, model, ()) is None:
        pieces += 1
        assert adviser.due(model, now)  # until it is done
    assert pieces > 0
    other = Model(model.content)
    assert not adviser.due(other, time.monotonic())
    assert adviser.due(other, now + 1e3 + LOOK_EVERY)
    assert not adviser.due(model, now + 1e3 + LOOK_EVERY)

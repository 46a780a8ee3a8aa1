# SPDX-License-Identifier: Apache-2.0
"""When nothing may be learned, and that it is learned again afterwards."""

from __future__ import annotations

import math
from dataclasses import replace

from sample_models import make_model, named

from slipwise.live.gates import RECOVERY, GateRules, Gates, rules_for
from slipwise.live.samples import Command, Override, Pose, Wheels
from slipwise.models import Model


def made(speed: tuple[float, float]) -> Model:
    return make_model(replace(named("edd-2"), speed=speed))


def test_an_operator_closes_the_gates_until_a_moment_after() -> None:
    gates = Gates(GateRules(), input_name="command")
    gates.take(Command(0.0, 0.5, 0.0))
    assert gates.why(0.0) == ""
    gates.take(Override(1.0, True))
    assert gates.why(1.0) == "an operator drives"
    gates.take(Override(5.0, False))
    assert "operator" in gates.why(5.0 + 0.9 * RECOVERY)
    assert gates.why(5.1 + RECOVERY) == ""


def test_reverse_closes_them_only_where_it_was_never_learned() -> None:
    for allowed in (True, False):
        gates = Gates(GateRules(reverse=allowed), input_name="wheel")
        gates.take(Wheels(0.0, -0.4, 0.0))
        assert (gates.why(0.1) == "") is allowed
        assert gates.why(0.1 + RECOVERY) == ""


def test_reverse_is_learned_from_nothing_and_from_a_model_that_drove_so() -> None:
    forward = made((0.0, 1.0))
    both = made((-0.5, 1.0))
    assert rules_for(None).reverse
    assert not rules_for(forward).reverse
    assert rules_for(both).reverse


def test_a_command_beyond_what_the_drive_reaches_closes_them() -> None:
    gates = Gates(GateRules(saturation=(1.0, 2.0)), input_name="command")
    gates.take(Command(0.0, 0.9, -1.9))
    assert gates.why(0.0) == ""
    gates.take(Command(0.1, 0.5, -2.5))
    assert "beyond" in gates.why(0.2)
    gates.take(Wheels(0.2, 9.0, 9.0))  # not what is learned from
    assert gates.why(0.2 + RECOVERY) == ""


def test_stale_input_is_said_and_closes_nothing() -> None:
    gates = Gates(GateRules(stale_after=1.0), input_name="wheel")
    assert gates.waits(0.0) == "no input yet"
    gates.take(Wheels(0.0, 0.5, 0.0))
    assert gates.waits(0.9) == ""
    assert gates.waits(3.0) == "the input is stale by 3.0 s"
    assert gates.why(3.0) == ""


def test_a_second_robot_on_the_pose_topic_closes_them() -> None:
    gates = Gates(GateRules(), input_name="wheel")
    for k in range(20):
        gates.take(Pose(0.1 * k, 0.02 * k, 0.0, 0.0))
        gates.take(Pose(0.1 * k + 0.03, 25.0, 3.0, 1.0))
    assert gates.why(1.93) == "two sources speak on the pose topic"


def test_a_clock_that_was_set_opens_what_time_had_closed() -> None:
    gates = Gates(GateRules(reverse=False), input_name="wheel")
    gates.take(Wheels(4000.0, -1.0, 0.0))
    gates.restart()
    assert gates.why(100.0) == ""
    assert gates.waits(100.0) == "no input yet"
    assert math.isfinite(RECOVERY)

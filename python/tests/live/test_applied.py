# SPDX-License-Identifier: Apache-2.0
"""What others have follows what was learned slowly, within a range, and only while it is valid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_models import make_model, named

from slipwise.live.applied import FARTHEST, LONGEST_STEP, AppliedModel, physical
from slipwise.live.outputs import Validity
from slipwise.models import Model

START = make_model(named("edd-2"))
NAMES = [p.name for p in START.content.parameters]


def learned(value: float) -> Model:
    return make_model(replace(named("edd-2"), values=dict.fromkeys(NAMES, value)))


def estimated(_name: str) -> Validity:
    return "estimated"


def test_it_never_moves_faster_than_stated_and_arrives() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.02)
    prior = {p.name: p.prior_std for p in goal.content.parameters}
    before = dict(applied.values)
    applied.step(0.0, goal, estimated)
    assert applied.values == before  # nothing is known of how long it was
    for k in range(1, 400):
        applied.step(0.5 * k, goal, estimated)
        for name in NAMES:
            assert abs(applied.values[name] - before[name]) <= 0.01 * prior[name] * 0.5 + 1e-12
        before = dict(applied.values)
    assert all(applied.values[name] == pytest.approx(0.02) for name in NAMES)


def arrived(goal: Model) -> AppliedModel:
    applied = AppliedModel(10.0, START)
    for k in range(2000):
        applied.step(float(k), goal, estimated)
    return applied


def test_a_skid_steer_that_is_known_well_is_followed_all_the_way() -> None:
    goal = make_model(replace(named("edd-2"), values={"ang.w": -0.43}))  # +- 0.01, the prior's is 0.3
    applied = arrived(goal)
    assert applied.values["ang.w"] == pytest.approx(-0.43)
    assert applied.held == {}


def test_what_is_not_certain_is_held_within_its_range_about_the_start_and_that_is_said() -> None:
    goal = make_model(replace(named("edd-2"), values={"ang.w": -0.43}, std=0.2))
    prior = {p.name: p.prior_std for p in goal.content.parameters}
    applied = arrived(goal)
    assert applied.values["ang.w"] == pytest.approx(-prior["ang.w"])
    assert applied.held.keys() == {"ang.w"}
    assert "ang.w is held at -0.3" in applied.held["ang.w"]


def test_nothing_is_followed_beyond_what_a_robot_can_be() -> None:
    goal = learned(1e3)
    applied = arrived(goal)
    for p in goal.content.parameters:
        assert applied.values[p.name] == pytest.approx(FARTHEST * p.prior_std)
    assert applied.held.keys() == set(NAMES)


def test_nothing_moves_while_the_model_or_the_parameter_is_not_valid() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.02)

    def first_alone(name: str) -> Validity:
        return "estimated" if name == NAMES[0] else "invalid"

    for k in range(5):
        applied.step(float(k), None, estimated)
    assert applied.values == applied.start
    for k in range(5, 10):
        applied.step(float(k), goal, first_alone)
    assert applied.values[NAMES[0]] > 0.0
    assert applied.values[NAMES[1]] == 0.0


def test_time_without_a_valid_model_is_not_made_up_for() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.02)
    applied.step(0.0, goal, estimated)
    applied.step(1000.0, None, estimated)
    applied.step(1001.0, goal, estimated)
    prior = {p.name: p.prior_std for p in goal.content.parameters}
    assert all(abs(applied.values[name]) <= 0.01 * prior[name] + 1e-12 for name in NAMES)


def test_a_long_standstill_is_not_made_up_for_in_one_step() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.9)
    prior = {p.name: p.prior_std for p in goal.content.parameters}
    for k in range(3):  # judgements at the usual distance move it
        applied.step(2.0 * k, goal, estimated)
    before = dict(applied.values)
    assert all(before[name] == pytest.approx(0.01 * prior[name] * 4.0) for name in NAMES)
    applied.step(4.0 + 3600.0, goal, estimated)  # the robot stood for an hour
    for name in NAMES:
        assert 0.0 < applied.values[name] - before[name] <= 0.01 * prior[name] * LONGEST_STEP + 1e-12


def test_others_are_told_after_the_interval_and_only_of_a_change() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.02)
    told = []
    for k in range(200):
        applied.step(0.5 * k, goal, estimated)
        if applied.due(0.5 * k, goal):
            applied.handed_on(0.5 * k)
            told.append(0.5 * k)
    assert told
    assert np.all(np.diff(told) >= 10.0)
    assert told[-1] < 60.0  # it has arrived, and there is nothing new


def test_its_covariance_holds_how_far_it_is_from_what_was_learned() -> None:
    applied, goal = AppliedModel(10.0, START), learned(0.1)
    applied.step(0.0, goal, estimated)
    given = applied.model(goal)
    assert given.mean == pytest.approx(0.0)
    assert np.diag(given.covariance) == pytest.approx(np.diag(goal.covariance) + 0.1**2)


def test_a_call_takes_all_at_once_but_clipped() -> None:
    applied, goal = AppliedModel(10.0, START), learned(1e3)
    applied.jump(goal, estimated)
    for p in goal.content.parameters:
        assert applied.values[p.name] == pytest.approx(FARTHEST * p.prior_std)


def test_without_a_start_model_slip_starts_at_zero_and_a_delay_at_what_was_learned() -> None:
    goal = make_model(replace(named("edd-2"), commands=True))
    applied = AppliedModel(10.0, None)
    applied.step(0.0, goal, estimated)
    assert physical("delay_v", applied.values) == pytest.approx(goal["delay_v"].value)
    assert all(applied.start[name] == 0.0 for name in NAMES)
    assert physical("nothing", applied.values) is None

# SPDX-License-Identifier: Apache-2.0
"""What arrives of commands is found whatever lag, delay and slip there are, with a spread that holds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

import slipwise as sw
from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.calibration.shares import PoseSensor, shares_of
from slipwise.logs import Inputs, Log, Poses
from slipwise.logs.motion_windows import evidence_of
from slipwise.models.difference import differences
from slipwise.models.schema import AxisShares
from slipwise.models.share_words import share_sentences

SLIP = (-0.1, -0.6)  # of speed and yaw rate: 90 and 40 % arrive
DRIVE = Drive(seconds=120.0, lag=0.4, delay=0.2, basis=_core.named_basis("edd-2"), alpha=SLIP)


def of_axes(log: Log) -> list[AxisShares]:
    shares = shares_of(evidence_of(log.runs, 0.5).windows)
    assert shares is not None
    assert shares.speed is not None
    assert shares.yaw_rate is not None
    return [shares.speed, shares.yaw_rate]


def test_shares_hold_the_truth_of_many_drives() -> None:
    """Of 90 % intervals, at least as many hold it; and none is so wide that it says nothing."""
    held, widest = [], 0.0
    for seed, lag in [(seed, lag) for seed in range(15) for lag in (0.0, 0.3, 0.8)]:
        axes = of_axes(simulated_log(replace(DRIVE, seed=seed, lag=lag, delay=lag / 2.0)))
        for axis, slip in zip(axes, SLIP, strict=True):
            assert axis.wheels is not None
            assert axis.floor is not None
            pairs = ((axis.arrives, 1.0 + slip), (axis.wheels, 1.0), (axis.floor, 1.0 + slip))
            held += [abs(share.value - truth) < 1.645 * share.std + 0.002 for share, truth in pairs]
            widest = max(widest, *(share.std for share, _ in pairs))
            assert axis.below is None, f"seed {seed}, lag {lag}: this robot is in proportion"
            assert axis.forward is None, f"seed {seed}, lag {lag}: this robot turns alike to both sides"
    assert np.mean(held) >= 0.9
    assert widest < 0.15


def test_a_dead_band_is_no_one_share() -> None:
    run = simulated_log(DRIVE).runs[0]
    assert run.commands is not None
    asked = replace(run.commands, omega=run.commands.omega + 0.25 * np.sign(run.commands.omega))
    _, yaw_rate = of_axes(Log(runs=(replace(run, commands=asked),)))
    assert yaw_rate.below is not None
    assert yaw_rate.small is not None
    assert yaw_rate.large is not None
    assert yaw_rate.small.value + 3.0 * yaw_rate.small.std < yaw_rate.large.value


def test_a_model_says_it_and_keeps_it_and_models_are_compared_by_it() -> None:
    model = calibrate(simulated_log(DRIVE), input="command").model
    other = calibrate(simulated_log(replace(DRIVE, alpha=(-0.1, -0.3))), input="command").model
    assert model.content.shares == sw.models.parse_model(model.to_yaml(), where="text").content.shares
    (sentence,) = share_sentences(model)
    assert sentence.startswith("Over this log, 90")
    assert "of that on the floor" in sentence
    rows = {row.name: row for row in differences(model, other)}
    assert not rows["share of speed"].different
    assert rows["share of yaw rate"].different
    assert calibrate(simulated_log(DRIVE), input="wheel").model.content.shares is None


def test_a_robot_that_veers_turns_alike_to_both_sides() -> None:
    """It turns by 0.15 rad for each metre, as with a tyre that is flat."""
    basis = _core.named_basis("full-linear-6")
    slip = (-0.1, 0.0, 0.0, 0.0, 0.15, -0.3)  # lon, lat and ang of V and w
    _, yaw_rate = of_axes(simulated_log(replace(DRIVE, basis=basis, alpha=slip)))
    assert yaw_rate.forward is None
    for share in (yaw_rate.arrives, yaw_rate.floor):
        assert share is not None
        assert share.value == pytest.approx(0.7, abs=max(0.01, 2.0 * share.std))


def test_on_one_circle_no_turn_is_taken_for_veering() -> None:
    t = np.arange(0.0, 100.0, 0.05)
    v = np.random.default_rng(1).uniform(0.4, 1.2, 20)[(t // 5.0).astype(int)]
    yaw = 0.3 * np.append(0.0, np.cumsum(v[:-1]) * 0.05)  # 60 % of what is commanded
    run = simulated_log(replace(DRIVE, seconds=1.0)).runs[0]
    commands = Inputs(t=t, v=v, vy=0.0 * t, omega=0.5 * v)
    poses = Poses(
        t=t, x=np.sin(yaw) / 0.3, y=(1.0 - np.cos(yaw)) / 0.3, yaw=yaw, frame=np.zeros(len(t), np.int64)
    )
    circled = replace(run, commands=commands, wheels=commands, poses=poses)
    for share, truth in zip(of_axes(Log(runs=(circled,))), (1.0, 0.6), strict=True):
        assert share.arrives.value == pytest.approx(truth, abs=0.01)


def test_few_windows_say_nothing() -> None:
    assert shares_of(evidence_of(simulated_log(replace(DRIVE, seconds=20.0)).runs, 0.5).windows) is None


def test_a_sensor_that_is_known_to_be_turned_and_off_centre_changes_nothing() -> None:
    rows = evidence_of(simulated_log(DRIVE).runs, 0.5).windows
    turned = rows.copy()
    turn = np.array([[np.cos(1.2), -np.sin(1.2)], [np.sin(1.2), np.cos(1.2)]])
    turned[:, 17:] = rows[:, 17:] @ turn  # ways ahead and left, by the yaw that it measures
    plain, known = shares_of(rows), shares_of(turned, sensor=PoseSensor(yaw=1.2))
    assert plain is not None
    assert known is not None
    assert plain.speed is not None
    assert known.speed is not None
    assert known.speed.arrives.value == pytest.approx(plain.speed.arrives.value)


CURVES = replace(DRIVE, lag=0.3, alpha=(-0.05, -0.3), speeds=(0.05, 0.4), yaw_rates=(-2.5, 2.5))


def of_speed(log: Log, *, positions: bool = False) -> AxisShares:
    if positions:
        log = Log(runs=tuple(replace(run, poses=replace(run.poses, course=True)) for run in log.runs))
    rows = evidence_of(log.runs, 0.5).windows
    shares = shares_of(rows, PoseSensor(positions=positions))
    assert shares is not None
    assert shares.speed is not None
    assert shares.speed.floor is not None
    return shares.speed


def test_curves_take_nothing_from_a_speed() -> None:
    """Chords of windows that turn by 2 rad, and back, are 3 % shorter than the ways."""
    off = []
    for seed in range(10):
        speed = of_speed(simulated_log(replace(CURVES, seed=seed, seconds=180.0)))
        assert speed.floor is not None
        off += [(each.value - 0.95) / each.std for each in (speed.arrives, speed.floor)]
        assert speed.floor.std < 0.005
    assert np.sqrt(np.mean(np.square(off))) < 1.5
    assert abs(np.mean(off)) < 0.7


@pytest.mark.parametrize("noise", [0.005, 0.02])
def test_neither_noise_nor_curves_bias_the_speed_of_positions_alone(noise: float) -> None:
    """Of a log without headings, windows that turn far say nothing; the others lose nothing by noise."""
    off, curve = [], replace(CURVES, speeds=(0.1, 1.0), yaw_rates=(-1.2, 1.2), pose_std=(noise, 0.0))
    for seed in range(8):
        log = simulated_log(replace(curve, seed=seed, seconds=180.0))
        speed = of_speed(log, positions=True)
        assert speed.floor is not None
        assert speed.windows < of_speed(log).windows
        assert speed.floor.std < 0.012
        off += [(each.value - 0.95) / each.std for each in (speed.arrives, speed.floor)]
    assert np.sqrt(np.mean(np.square(off))) < 1.5
    assert abs(np.mean(off)) < 0.7


@pytest.mark.parametrize("seed", range(3))
def test_courses_that_noise_turns_round_say_nothing_of_turns(seed: int) -> None:
    """Positions at 1 Hz with 0.4 m of noise: what they say of turns is far too little."""
    drive = replace(CURVES, seed=seed, seconds=400.0, speeds=(0.3, 2.0), yaw_rates=(-1.0, 1.0))
    run = simulated_log(replace(drive, pose_std=(0.4, 0.0))).runs[0]
    seldom = np.flatnonzero(np.diff(np.floor(run.poses.t)) > 0.0)
    thin = Poses(
        *(each[seldom] for each in (run.poses.t, run.poses.x, run.poses.y, run.poses.yaw)),
        run.poses.frame[seldom],
        course=True,
    )
    rows = evidence_of([replace(run, poses=thin)], 0.5).windows
    shares = shares_of(rows, sensor=PoseSensor(positions=True))
    assert shares is not None
    assert shares.yaw_rate is None
    assert shares.speed is not None
    assert shares.speed.floor is not None
    assert abs(shares.speed.floor.value - 0.95) < 3.0 * shares.speed.floor.std


def test_an_antenna_off_centre_is_no_speed() -> None:
    drive = replace(CURVES, speeds=(0.1, 1.0), yaw_rates=(-1.2, 1.2), seconds=300.0)
    run = simulated_log(drive).runs[0]
    ahead = replace(
        run.poses, x=run.poses.x + 0.4 * np.cos(run.poses.yaw), y=run.poses.y + 0.4 * np.sin(run.poses.yaw)
    )
    speed = of_speed(Log(runs=(replace(run, poses=ahead),)), positions=True)
    assert speed.floor is not None
    assert speed.floor.value == pytest.approx(0.95, abs=3.0 * speed.floor.std)
    assert speed.floor.std < 0.02


def test_a_side_that_turns_less_is_told_from_the_other() -> None:
    run = simulated_log(DRIVE).runs[0]
    assert run.commands is not None
    omega = run.commands.omega
    asked = replace(run.commands, omega=np.where(omega < 0.0, 2.0 * omega, omega))
    _, yaw_rate = of_axes(Log(runs=(replace(run, commands=asked),)))
    assert yaw_rate.backward is not None
    assert yaw_rate.forward is not None
    assert yaw_rate.backward.value == pytest.approx(0.2, abs=0.04)
    assert yaw_rate.forward.value == pytest.approx(0.4, abs=0.08)


@pytest.mark.parametrize("seed", range(4))
def test_another_ground_is_no_other_side_and_no_other_size(seed: int) -> None:
    """On the first ground the robot turns right, mostly, and slowly; on the second to the left, and fast."""
    first = replace(DRIVE, seconds=400.0, seed=seed, yaw_rates=(-0.6, 0.2), alpha=(-0.1, -0.3))
    second = replace(first, seed=seed + 100, yaw_rates=(-0.2, 1.2), alpha=SLIP)
    for axis in of_axes(Log(runs=tuple(simulated_log(each).runs[0] for each in (first, second)))):
        assert (axis.below, axis.backward) == (None, None)

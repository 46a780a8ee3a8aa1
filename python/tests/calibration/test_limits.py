# SPDX-License-Identifier: Apache-2.0
"""Limits of the drive: found where wheel speeds or poses show them, never from the future."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from limited_drives import CHAIN, FREE, NOISE, SIDES, TRACK, search, track_of, wheels_behind
from sample_models import make_model, named

from slipwise import _core
from slipwise.calibration import Settings, calibrate
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.judge import limits_advice
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.mppi import dead_bands
from slipwise.export.parameter_file import Entry
from slipwise.logs import open_log
from slipwise.logs.log import Inputs, Log, Poses, Run, Source
from slipwise.models import Model, load_model
from slipwise.models.limits import AxisLimitsSection, LearnedLimit, LimitsSection
from slipwise.models.summary import summarise
from slipwise.planning import Controller, ReferencePath, Start, rollout, sample_futures
from slipwise.planning.mppi import learned_motions
from slipwise.prediction import predict
from slipwise.segments import recording_of
from slipwise_sim import Scenario, dull_drive, simulate, steps_drive

SLIP = (-0.06, -0.35)  # lon.V, ang.w
SECONDS = 180.0


def driven(commands: Inputs, wheels: Inputs, seed: int = 1) -> Log:
    """A log with commands, wheel speeds, and poses of a robot that slips."""
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    whole = _core.Segment(0.0, float(wheels.t[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(model, np.array(SLIP), track_of(wheels), whole, _core.Integrator.Exact)
    noise = np.random.default_rng(seed).normal(0.0, 1.0, (len(path.poses), 3)) * (0.01, 0.01, 0.005)
    x, y, yaw = np.ascontiguousarray((path.poses + noise).T)
    poses = Poses(t=np.array(path.times), x=x, y=y, yaw=yaw, frame=np.zeros(len(x), dtype=np.int64))
    run = Run(name="run", poses=poses, commands=commands, wheels=wheels)
    return Log((run,), (Source("simulated", "0", "simulated", len(x)),), (), ())


@pytest.fixture(scope="module")
def log() -> Log:
    commands = steps_drive(3, SECONDS)
    return driven(commands, wheels_behind(SIDES, commands, 1))


@pytest.fixture(scope="module")
def model(log: Log) -> Model:
    return calibrate(log, input="command").model


def test_a_drive_that_is_too_dull_says_what_would_show_a_limit() -> None:
    found = search(SIDES, dull_drive(1, 60.0), 1)
    assert not {limit.kind for limit in found.found} & {_core.LimitKind.saturation, _core.LimitKind.dead_band}
    text = " ".join(limits_advice(found))
    assert "No saturation found; the largest commands were 1.0 m/s" in text
    assert "No dead band found" in text


def test_simulated_physics_behind_limits_show_them() -> None:
    side = _core.AxisLimits(0.15, 1.2, 1.0, 1.5)
    limits = _core.CommandLimits(FREE, FREE, side, TRACK, 1.0, 1.0)
    scenario = Scenario(duration=90.0, drive="steps", limits=limits)
    run = simulate(scenario, seed=2).log.runs[0]
    rows = np.column_stack((run.wheels.t, run.wheels.v, run.wheels.omega))
    record = _core.WheelRecord(track_of(run.commands), np.ascontiguousarray(rows))
    found = _core.find_limits([record], _core.PriorSettings(), 1.0, _core.LEAST_LIMIT_GAIN, None)
    tops = [
        f for f in found.found if f.kind == _core.LimitKind.saturation and f.axis == _core.LimitedAxis.Side
    ]
    assert len(tops) == 1
    assert tops[0].value == pytest.approx(1.2, rel=0.05)


def test_limits_are_used_where_they_predict_better(model: Model) -> None:
    limits = model.limits
    assert limits is not None
    assert limits.side.saturation == pytest.approx(1.5, rel=0.02)
    assert limits.side.slew_rate_up == pytest.approx(1.2, rel=0.05)
    assert limits.wheel_separation == pytest.approx(TRACK, rel=0.05)


def test_without_the_cascaded_structure_there_are_none(log: Log) -> None:
    settings = Settings(auto={"structures": ["joint"]})
    learned = calibrate(log, input="command", settings=settings).model
    assert learned.limits is None


def test_a_model_with_limits_is_saved_and_predicts_as_before(model: Model, tmp_path) -> None:
    read = load_model(model.save(tmp_path / "m.yaml"))
    assert read.content == model.content
    fast = predict(read, [(0.0, 3.0, 0.0)], horizon=5.0)
    limited = predict(read, [(0.0, 1.5, 0.0)], horizon=5.0)
    assert fast.poses[-1, 0] == pytest.approx(limited.poses[-1, 0], rel=0.03)
    assert predict(read, [(0.0, 0.05, 0.0)], horizon=5.0).poses[-1, 0] == pytest.approx(0.0, abs=1e-9)


def test_a_model_with_limits_plans_as_it_predicts(model: Model) -> None:
    t = np.arange(100) * 0.05
    smooth = np.stack((0.8 + 0.7 * np.sin(1.3 * t), 0.8 * np.sin(2.1 * t)), axis=1)
    steps = np.where(t[:, None] < 2.5, (1.2, 0.5), (0.3, -0.6))
    before = np.zeros((60, 2))
    for commands in (smooth, steps):
        start = Start(past=before)
        found = rollout(model, commands[None], 0.05, start=start, covariance=True)
        assert found.path is not None
        assert found.covariance is not None
        rows = np.column_stack((np.arange(-60, 100) * 0.05, np.vstack((before, commands))))
        path = predict(model, rows, horizon=5.0, start=0.0, initial=(0.0, 0.0))
        # Where no ramp is left, predictions take longer steps while a lag closes.
        assert found.path[:, -1, 0] == pytest.approx(path.poses[-1], abs=1e-4)
        free = model.with_table(model.table.without("limits"), limit_gains=None)
        apart = predict(free, rows, horizon=5.0, start=0.0, initial=(0.0, 0.0)).poses[-1] - path.poses[-1]
        assert np.hypot(apart[0], apart[1]) > 0.01
        futures = sample_futures(model, commands[None], 0.05, samples=200, seed=1, start=start)
        covariance = found.covariance[:, -1, 0]
        assert futures[0, :, -1, 0].var() == pytest.approx(covariance[0], rel=0.3)
    controller = Controller(learned_motions(model), ReferencePath(np.array([[0.0, 0.0], [20.0, 0.0]]), 0.8))
    assert controller.command((0.0, 0.0, 0.0), (0.5, 0.0))[0] > 0.0


def test_dead_bands_of_commands_reach_the_parameters_of_nav2() -> None:
    def learned(value: float) -> LearnedLimit:
        return LearnedLimit(value=value, std=0.01)

    axis = AxisLimitsSection(dead_band=learned(0.1), saturation=learned(1.0), slew_rate_up=learned(2.0))
    none = AxisLimitsSection()
    section = LimitsSection(
        speed=axis,
        yaw_rate=none,
        side=none,
        wheel_separation=1.0,
        wheel_separation_std=0.0,
        gain_v=1.0,
        gain_omega=1.0,
    )
    numbers = LearnedNumbers(make_model(replace(named("edd-2"), commands=True)))
    entries = {entry.key: entry.value for entry in dead_bands(section, numbers) if isinstance(entry, Entry)}
    assert entries[("VelocityDeadbandCritic", "deadband_velocities")] == [0.1, 0.0, 0.0]
    assert dead_bands(None, numbers) == []


def without_wheels(log: Log) -> Log:
    return replace(log, runs=tuple(replace(run, wheels=None) for run in log.runs))


def test_limits_are_learned_from_commands_and_poses_alone() -> None:
    limits = SIDES
    commands = steps_drive(3, SECONDS)
    log = without_wheels(driven(commands, wheels_behind(limits, commands, 1)))
    learned = calibrate(log, input="command").model
    assert learned.limits is not None
    assert learned.limits.wheel_separation == pytest.approx(TRACK, rel=0.02)
    for axis, truth in (
        (learned.limits.speed, limits.speed),
        (learned.limits.yaw_rate, limits.yaw_rate),
        (learned.limits.side, limits.side),
    ):
        assert axis.dead_band == pytest.approx(truth.dead_band, abs=0.03)
        assert axis.saturation == pytest.approx(truth.saturation, rel=0.03)
        assert axis.slew_rate_up == pytest.approx(truth.slew_rate_up, rel=0.05)
        assert axis.slew_rate_down == pytest.approx(truth.slew_rate_down, rel=0.05)
    known = {p.name: p for p in learned.content.parameters}
    held = 0.025  # s by which the simulated robot is later: it drives each wheel speed until the next
    for name, truth in (
        ("time_constant_v", CHAIN.time_constant_v),
        ("time_constant_omega", CHAIN.time_constant_omega),
    ):
        assert abs(known[f"log_{name}"].value - np.log(truth)) < 3.0 * known[f"log_{name}"].std
    for name, truth in (("delay_v", CHAIN.delay_v + held), ("delay_omega", CHAIN.delay_omega + held)):
        assert abs(known[f"log_{name}"].value - np.log(truth)) < 3.0 * known[f"log_{name}"].std


def rated_wheels(commands: Inputs, chain: _core.ActuatorModel, up: float, down: float) -> Inputs:
    """What wheels do whose speed itself cannot change more quickly, behind its lag, in steps of 1 ms."""
    drive = _core.actuator_output(track_of(commands), chain, commands.t, _core.BodyTwist(0.0, 0.0, 0.0))
    step, period, speed = 1e-3, 0.05, 0.0
    fine = np.arange(round(float(commands.t[-1]) / step) + 1) * step - chain.delay_v
    asked = np.where(fine < 0.0, 0.0, commands.v[np.maximum((fine / period + 1e-6).astype(int), 0)])
    speeds = [speed]
    for command in asked[1:].tolist():
        most = down if (command - speed) * speed < 0.0 else up
        speed += step * min(max((command - speed) / chain.time_constant_v, -most), most)
        speeds.append(speed)
    v = np.array(speeds)[np.rint(commands.t / step).astype(int)]
    noise = np.random.default_rng(5).normal(size=(2, len(v)))
    return replace(
        commands, v=v + NOISE[0] * noise[0], omega=np.ascontiguousarray(drive[:, 1]) + NOISE[1] * noise[1]
    )


@pytest.mark.parametrize("wheels_logged", [True, False])
@pytest.mark.parametrize("lag", [0.3, 0.6])
def test_rates_of_the_drive_itself_are_found_behind_its_lag(
    lag: float, wheels_logged: bool, tmp_path: Path
) -> None:
    commands = steps_drive(3, SECONDS)
    log = driven(commands, rated_wheels(commands, _core.ActuatorModel(lag, 0.2, 0.15, 0.1, 0.0), 0.5, 0.8))
    learned = calibrate(log if wheels_logged else without_wheels(log), input="command").model
    read = load_model(learned.save(tmp_path / "m.yaml"))
    assert read.limits_section is not None
    found = read.limits_section.speed
    for limit, truth in ((found.slew_rate_up, 0.5), (found.slew_rate_down, 0.8), (found.slew_rate_lag, lag)):
        assert limit is not None
        assert abs(limit.value - truth) < 3.0 * limit.std
    assert found.slew_rate_up is not None
    assert found.slew_rate_up.value == pytest.approx(0.5, rel=0.02 if wheels_logged else 0.1)
    assert "behind a lag of" in " ".join(summarise(read).sentences)


def test_a_drive_without_limits_shows_none_in_its_poses() -> None:
    commands = steps_drive(3, SECONDS)
    unlimited = _core.CommandLimits(FREE, FREE, FREE, TRACK, 1.0, 1.0)
    result = calibrate(
        without_wheels(driven(commands, wheels_behind(unlimited, commands, 1))), input="command"
    )
    assert result.model.limits is None
    assert not any("looks limited" in each for each in result.verdict.advice)


@pytest.mark.slow
def test_limits_that_change_are_found_again() -> None:
    commands, half = steps_drive(3, 2.0 * SECONDS), SECONDS
    slower = _core.CommandLimits(FREE, FREE, _core.AxisLimits(0.12, 0.8, 0.6, 2.0), TRACK, 1.0, 1.0)
    first, second = (wheels_behind(limits, commands, 1) for limits in (SIDES, slower))
    late = commands.t >= half
    changed = replace(
        first, v=np.where(late, second.v, first.v), omega=np.where(late, second.omega, first.omega)
    )
    learned = calibrate(driven(commands, changed), input="command").model.limits
    assert learned is not None
    assert learned.side.saturation == pytest.approx(0.8, rel=0.1)


def test_limits_that_explain_little_one_by_one_are_found_together(real_log_dir: Path) -> None:
    """A stretch of a Husky that drives random commands shows the rates of its yaw rate."""
    log = open_log(real_log_dir / "drive_test" / "husky.csv.gz")
    learner = _core.MotionLearner(core_settings(Settings(), "command", ()))
    for run in log.runs[4:6]:
        learner.start_run()
        learner.push(recording_of(run))
    found = {(f.axis, f.kind): f.value for f in learner.find_limits(TRACK).search.found}
    assert found[(_core.LimitedAxis.YawRate, _core.LimitKind.slew_rate_up)] == pytest.approx(2.6, rel=0.1)
    assert found[(_core.LimitedAxis.YawRate, _core.LimitKind.slew_rate_down)] == pytest.approx(2.65, rel=0.1)


def test_looking_for_limits_changes_nothing_that_is_learned(log: Log) -> None:
    def learned(*, asked: bool) -> _core.MotionPosterior:
        learner = _core.MotionLearner(core_settings(Settings(), "command", ()))
        learner.start_run()
        learner.push(recording_of(log.runs[0], until=60.0))
        if asked:
            learner.find_limits(TRACK)
        learner.push(recording_of(log.runs[0], since=60.0))
        return learner.model().motion

    asked, other = learned(asked=True), learned(asked=False)
    assert asked.estimate.mean.tobytes() == other.estimate.mean.tobytes()

# SPDX-License-Identifier: Apache-2.0
"""Chain and slip learned in cascade where wheel speeds lie between commands and poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise import _core
from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.drive import prepare_drive
from slipwise.calibration.learner import BASELINE, CASCADE, DIRECT, STRUCTURES, TOGETHER, make_learner
from slipwise.calibration.structure_choice import StructureChoice
from slipwise.logs.log import Inputs, Log, Poses, Run, Source
from slipwise.simulation.known_robot import KnownRobot, known_run

LAG, DELAY, SLOW_SHARE, SLOW_LAG = (0.3, 0.5), (0.12, 0.2), (0.2, 0.4), (1.6, 2.2)
GAIN = (0.95, 0.9)
SLIP = (-0.06, -0.35)  # lon.V, ang.w
OFFSET = 0.15  # s
SECONDS, PERIOD = 300.0, 0.05


def response(u: np.ndarray, channel: int) -> np.ndarray:
    """The drive at the samples of `u` [N], stepped finely: gain, delay, two lags side by side."""
    fine = 10
    h = PERIOD / fine
    held = np.repeat(u, fine)
    late = round(DELAY[channel] / h)
    delayed = GAIN[channel] * np.concatenate((np.full(late, held[0]), held[: len(held) - late]))
    share, fast, slow = SLOW_SHARE[channel], 0.0, 0.0
    out = np.empty(len(u))
    for i, value in enumerate(delayed):
        if i % fine == 0:
            out[i // fine] = fast + slow
        fast += (1.0 - np.exp(-h / LAG[channel])) * ((1.0 - share) * value - fast)
        slow += (1.0 - np.exp(-h / SLOW_LAG[channel])) * (share * value - slow)
    return out


def simulated(seed: int, *, seconds: float = SECONDS, wheel_noise: float = 0.01) -> Log:
    """A robot with a known chain, known slip and late poses, under steps of commands."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, PERIOD)
    steps = np.arange(0.0, seconds, 3.0)
    at = np.searchsorted(steps, t, side="right") - 1
    v = rng.uniform(-0.5, 1.0, len(steps))[at]
    omega = rng.uniform(-1.0, 1.0, len(steps))[at]
    drive = np.column_stack((response(v, 0), response(omega, 1)))
    mean = np.vstack((drive[1:] + drive[:-1], 2.0 * drive[-1:])) / 2.0  # over each period
    track = _core.InputTrack(t, mean[:, 0], np.zeros(len(t)), mean[:, 1])
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    whole = _core.Segment(0.0, float(t[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(model, np.array(SLIP), track, whole, _core.Integrator.Exact)
    noise = rng.normal(0.0, 1.0, (len(path.poses), 3)) * (0.01, 0.01, 0.005)
    x, y, yaw = np.ascontiguousarray((path.poses + noise).T)
    poses = Poses(t=np.array(path.times) + OFFSET, x=x, y=y, yaw=yaw, frame=np.zeros(len(x), dtype=np.int64))
    told = Inputs(t=t, v=v, vy=np.zeros(len(t)), omega=omega)
    seen = drive + rng.normal(0.0, wheel_noise, drive.shape)
    wheels = Inputs(t=t, v=seen[:, 0].copy(), vy=np.zeros(len(t)), omega=seen[:, 1].copy())
    run = Run(name="run", poses=poses, commands=told, wheels=wheels)
    return Log((run,), (Source("simulated", "0", "simulated", len(t)),), (), ())


@pytest.fixture(scope="module")
def log() -> Log:
    return simulated(3)


def final_belief(log: Log):
    settings = Settings()
    windows = learning_windows(prepare_drive(log, "command"), "command", settings)
    passing = CascadePass(windows, settings)
    belief = passing.belief(len(windows), np.ones(3))
    return {info.name: i for i, info in enumerate(passing.motion.parameters)}, belief


def test_a_cascade_finds_the_response_and_the_offset(log):
    place, belief = final_belief(log)

    def value(name: str) -> float:
        found = belief.mean[place[name]]
        return float(np.exp(found) if name.startswith("log_") else found)

    for k, channel in enumerate(("v", "omega")):
        share = value(f"slow_share_{channel}")
        lag, slow_lag = value(f"log_lag_{channel}"), value(f"log_slow_lag_{channel}")
        # Lags, share and delay trade places; the gain and the mean time to respond do not. A sample that is
        # held until the next one is half a period late on average.
        found = value(f"log_delay_{channel}") + (1.0 - share) * lag + share * slow_lag - PERIOD / 2.0
        true = DELAY[k] + (1.0 - SLOW_SHARE[k]) * LAG[k] + SLOW_SHARE[k] * SLOW_LAG[k]
        assert value(f"gain_{channel}") == pytest.approx(GAIN[k], abs=0.04)
        assert found == pytest.approx(true, rel=0.2)
    assert value("clock_offset") == pytest.approx(OFFSET - PERIOD / 2.0, abs=0.01)


def test_a_cascade_is_chosen_where_it_predicts_better(log):
    calibration = calibrate(log)
    assert calibration.model.content.response
    assert calibration.history.structures == STRUCTURES
    assert calibration.history.structure_weight[-1, CASCADE] > 0.8
    assert list(calibration.history.names) == [p.name for p in calibration.model.content.parameters]


def test_a_belief_states_whose_parameters_it_holds(log):
    settings = Settings()
    windows = learning_windows(prepare_drive(log, "command"), "command", settings)
    passing = StructureChoice(make_learner(settings, "command"), windows)
    for count, structure in ((0, BASELINE), (len(windows), CASCADE)):
        belief = passing.belief(count)
        assert belief.structure == structure
        assert belief.motion.response == (structure == CASCADE)
        assert len(belief.mean) == belief.motion.size


def test_a_model_with_a_response_is_saved_and_read_back(log, tmp_path):
    from slipwise.models.model import load_model

    model = calibrate(log).model
    read = load_model(model.save(tmp_path / "model.yaml"))
    assert read.motion.response
    np.testing.assert_allclose(read.mean, model.mean)


def test_wheels_that_tell_nothing_of_the_motion_are_not_followed(log):
    run = log.runs[0]
    rng = np.random.default_rng(1)
    broken = replace(
        run.wheels, v=rng.normal(0.0, 1.0, len(run.wheels)), omega=rng.normal(0.0, 1.0, len(run.wheels))
    )
    calibration = calibrate(replace(log, runs=(replace(run, wheels=broken),)))
    assert not calibration.model.content.response


def test_without_wheel_speeds_there_is_no_cascade(log):
    alone = replace(log, runs=(replace(log.runs[0], wheels=None),))
    settings = Settings()
    windows = learning_windows(prepare_drive(alone, "command"), "command", settings)
    belief = StructureChoice(make_learner(settings, "command"), windows).belief(len(windows))
    assert belief.structure == TOGETHER


def test_a_belief_never_depends_on_what_comes_later(log):
    run, until = log.runs[0], 120.0
    seen = run.poses.t <= until
    cut_poses = Poses(
        t=run.poses.t[seen],
        x=run.poses.x[seen],
        y=run.poses.y[seen],
        yaw=run.poses.yaw[seen],
        frame=run.poses.frame[seen],
    )

    def cut(inputs: Inputs) -> Inputs:
        told = inputs.t <= until
        return Inputs(t=inputs.t[told], v=inputs.v[told], vy=inputs.vy[told], omega=inputs.omega[told])

    short = replace(
        log, runs=(replace(run, poses=cut_poses, commands=cut(run.commands), wheels=cut(run.wheels)),)
    )
    settings = Settings()
    beliefs = []
    for each in (log, short):
        windows = learning_windows(prepare_drive(each, "command"), "command", settings)
        beliefs.append(StructureChoice(make_learner(settings, "command"), windows).belief(40))
    np.testing.assert_array_equal(beliefs[0].mean, beliefs[1].mean)
    np.testing.assert_array_equal(beliefs[0].covariance, beliefs[1].covariance)


def commanded(robot: KnownRobot, *, seconds: float = 120.0, seed: int = 2) -> Log:
    """A known robot's log under held random commands, without wheel speeds."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, PERIOD)
    at = np.floor(t / 2.0).astype(int)
    v, omega = rng.uniform(-0.5, 1.5, at[-1] + 1)[at], rng.uniform(-0.8, 0.8, at[-1] + 1)[at]
    run = known_run(robot, Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega), (2.0, seconds), random=rng)
    return Log((replace(run, wheels=None),), (Source("known", "0", "simulated", len(t)),), (), ())


IDEAL = KnownRobot(lag=(1e-9, 1e-9), delay=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0), pose_std=(0.005, 0.003))


def test_a_robot_that_obeys_exactly_is_predicted_as_the_baseline_predicts_it():
    calibration = calibrate(commanded(IDEAL))
    held_out = calibration.model.content.verdict.held_out
    assert calibration.history.structure_weight[-1].argmax() == BASELINE
    assert held_out.position <= 1.05 * held_out.plain_position
    assert held_out.heading <= 1.05 * held_out.plain_heading
    assert not calibration.verdict.good
    assert calibration.model.motion.size == 0


def test_a_robot_that_slips_and_never_lags_needs_no_actuator_model():
    slipping = replace(IDEAL, basis=_core.named_basis("edd-2"), slip=SLIP)
    calibration = calibrate(commanded(slipping))
    model = calibration.model
    assert calibration.verdict.good
    assert (model.content.delays, model.content.dynamics) == (True, False)
    found = dict(zip((p.name for p in model.content.parameters), model.mean, strict=True))
    assert found["delay_v"] == pytest.approx(0.0, abs=0.01)
    assert found["delay_omega"] == pytest.approx(0.0, abs=0.01)
    assert found["ang.w"] == pytest.approx(SLIP[1], abs=0.05)


def test_simpler_candidates_that_are_refuted_are_left_out_for_good():
    lagging = replace(IDEAL, lag=(0.5, 0.4), basis=_core.named_basis("edd-2"), slip=SLIP)
    weights = calibrate(commanded(lagging)).history.structure_weight
    for structure in (DIRECT, BASELINE):
        gone = np.flatnonzero(weights[:, structure] == 0.0)
        assert 0 < gone[0] < 45
        assert not weights[gone[0] :, structure].any()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)


@pytest.mark.parametrize(("key", "structure"), [("direct", DIRECT), ("baseline", BASELINE)])
def test_a_simpler_candidate_can_be_left_out_by_the_settings(key, structure):
    settings = make_settings({"auto": {key: False}})
    weights = calibrate(commanded(IDEAL, seconds=60.0), settings=settings).history.structure_weight
    assert not weights[:, structure].any()


def test_what_is_learned_about_slip_is_learned_about_a_candidate_that_has_slip():
    settings = Settings()
    windows = learning_windows(prepare_drive(commanded(IDEAL), "command"), "command", settings)
    choice = StructureChoice(make_learner(settings, "command"), windows)
    assert choice.belief(len(windows)).structure == BASELINE
    assert choice.slip_belief(len(windows)).structure != BASELINE

# SPDX-License-Identifier: Apache-2.0
"""A model predicts poses and covariances from commands, by the core's own integrator."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, held, simulated_log
from sample_models import make_model, named

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.plain import baseline_predictor, vendor_predictor
from slipwise.calibration.settings import Settings
from slipwise.errors import SettingsError
from slipwise.ground import ElevationMap, Grade
from slipwise.logs.log import Inputs
from slipwise.models import Model
from slipwise.models.schema import StudentT
from slipwise.prediction import predict, slip_seen, student_at
from slipwise.student import MOST_DOF

BASES = ["edd-2", "icr-3", "drive-5", "full-linear-6", "ipem-9", "odd-even-10", "thesis-15", "auto"]


def learned(basis: str, input_name: str, **settings: object) -> Model:
    log = simulated_log(Drive(seconds=40.0, lag=0.2, delay=0.1))
    return calibrate(log, input=input_name, settings=make_settings({"basis": basis, **settings})).model


@pytest.fixture(scope="module")
def model() -> Model:
    return learned("full-linear-6", "command", auto={"structures": ["joint"]})


def test_zero_command_gives_zero_motion(subtests: pytest.Subtests) -> None:
    for input_name in ["command", "wheel"]:
        for basis in BASES:
            with subtests.test(input_name=input_name, basis=basis):
                path = predict(learned(basis, input_name), np.zeros((1, 3)), horizon=3.0)
                assert np.array_equal(path.poses, np.zeros((31, 3)))


def test_path_has_a_pose_every_tenth_and_at_the_horizon(model: Model) -> None:
    path = predict(model, [[5.0, 1.0, 0.0]], horizon=0.35)
    assert path.t == pytest.approx([5.0, 5.1, 5.2, 5.3, 5.35])
    assert path.poses.shape == (5, 3)
    assert path.covariance.shape == (5, 3, 3)
    assert not path.poses[0].any()
    assert not path.covariance[0].any()


def test_prediction_is_the_cores_linearised_segment(model: Model) -> None:
    inputs = held(np.arange(0.0, 4.0, 0.5), 1.2, -0.4)
    path = predict(model, inputs, horizon=2.0, start=1.0, initial=(0.7, 0.1))
    history = _core.InputHistory(inputs.t, inputs.v, inputs.vy, inputs.omega)
    twist = _core.BodyTwist(0.7, 0.0, 0.1)
    segment = _core.Segment(1.0, 3.0, _core.Pose2(0.0, 0.0, 0.0), twist, 0.0, 0.0)
    at = _core.linearize_segment(model.motion, model.mean, history, segment)
    assert path.poses[-1].tobytes() == at.predicted.vector().tobytes()
    scale = np.array(model.content.noise.variance_scale)
    covariance = _core.prediction_covariance(at, model.covariance_over(2.0), model.noise, scale)
    assert path.covariance[-1] == pytest.approx(covariance * student_at(model, 2.0).inflation)


def test_slip_that_wanders_is_part_of_the_covariance_and_of_a_prediction_that_has_seen_it() -> None:
    made = replace(
        named("edd-2", lon__V=-0.05, ang__w=-0.3), disturbance=(0.2, 0.3, 20.0), fraction=0.0, psd_motion=1e-4
    )
    model, without = make_model(made), make_model(replace(made, disturbance=None))
    inputs = held(np.arange(0.0, 20.0, 0.5), 1.0, 0.5)
    moved = replace(made, values={"lon.V": -0.05, "ang.w": -0.15})
    seen = windows_of(make_model(moved), inputs, 12)
    start = {"horizon": 2.0, "start": seen[-1].end}
    plain = predict(without, inputs, **start)
    usual = predict(model, inputs, **start)
    followed = predict(model, inputs, **start, slip_now=slip_seen(model, inputs, seen))
    truth = predict(make_model(moved), inputs, **start)
    assert usual.poses.tobytes() == plain.poses.tobytes()
    assert (usual.covariance[-1].diagonal() > 1.2 * plain.covariance[-1].diagonal()).all()
    assert followed.covariance[-1, 2, 2] < 0.8 * usual.covariance[-1, 2, 2]
    errors = [abs(path.poses[-1, 2] - truth.poses[-1, 2]) for path in (usual, followed)]
    assert errors[1] < 0.3 * errors[0]
    with pytest.raises(ValueError, match="belongs to another model"):
        predict(without, inputs, **start, slip_now=slip_seen(model, inputs, seen))


def windows_of(model: Model, inputs: Inputs, count: int) -> list[_core.Segment]:
    """Windows of 1 s as a robot of this model would drive them."""
    history = _core.InputHistory(inputs.t, inputs.v, inputs.vy, inputs.omega)
    windows = []
    for start in range(count):
        bare = _core.Segment(start, start + 1.0, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
        path = _core.integrate_segment(model.motion, model.mean, history, bare, _core.Integrator.Exact)
        end = _core.Pose2(*path.poses[-1].tolist())
        windows.append(_core.Segment(start, start + 1.0, end, None, 0.0, 0.0))
    return windows


def test_uncertainty_grows_along_the_path(model: Model) -> None:
    path = predict(model, [[0.0, 1.0, 0.3]], horizon=5.0)
    trace = path.covariance[:, 0, 0] + path.covariance[:, 1, 1]
    assert (np.diff(trace) > 0.0).all()
    assert (np.diff(path.covariance[:, 2, 2]) > 0.0).all()
    assert (np.linalg.eigvalsh(path.covariance[1:]) > 0.0).all()


def test_tails_are_interpolated_and_held_beyond_the_judged_horizons(model: Model) -> None:
    students = model.content.noise.student_t
    for name in ("inflation", "dof"):
        two, five = getattr(students[2.0], name), getattr(students[5.0], name)
        assert getattr(student_at(model, 1.0), name) == pytest.approx(getattr(students[1.0], name))
        assert getattr(student_at(model, 0.1), name) == pytest.approx(getattr(students[1.0], name))
        assert getattr(student_at(model, 60.0), name) == pytest.approx(five)
        assert min(two, five) <= getattr(student_at(model, 3.0), name) <= max(two, five)
    assert predict(model, [[0.0, 1.0, 0.0]], horizon=2.0).dof[-1] == pytest.approx(students[2.0].dof)


def test_model_without_judged_horizons_is_nearly_normal_as_stated(model: Model) -> None:
    bare = Model(
        model.content.model_copy(update={"noise": model.content.noise.model_copy(update={"student_t": {}})})
    )
    assert student_at(bare, 2.0) == StudentT(inflation=1.0, dof=MOST_DOF)


def test_rows_and_inputs_are_the_same_commands(model: Model) -> None:
    inputs = held([0.0, 0.4, 0.8], 0.9, 0.2)
    rows = np.column_stack((inputs.t, inputs.v, inputs.omega))
    one, other = (predict(model, c, horizon=1.0).poses for c in (inputs, rows))
    assert one.tobytes() == other.tobytes()


def test_commands_of_a_wrong_kind_are_refused_with_advice(model: Model, subtests: pytest.Subtests) -> None:
    for commands in [
        np.zeros(3),
        np.zeros((0, 3)),
        np.zeros((4, 2)),
        np.zeros((2, 3, 1)),
        [[0.0, float("nan"), 0.0]],
        [[0.0, 1.0, float("inf")]],
        [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [0.0, 2.0, 0.0]],
        [["a", "b", "c"]],
        [[0.0, 1.0], [2.0]],
    ]:
        with (
            subtests.test(commands=commands),
            pytest.raises(SettingsError, match=r"commands .* numpy.column_stack"),
        ):
            predict(model, commands, horizon=1.0)


@pytest.mark.parametrize("horizon", [0.0, -1.0, float("nan"), float("inf")])
def test_horizon_must_be_positive_seconds(model: Model, horizon: float) -> None:
    with pytest.raises(SettingsError, match=r"the horizon must be positive seconds: such as horizon=5\.0"):
        predict(model, [[0.0, 1.0, 0.0]], horizon=horizon)


@pytest.mark.parametrize("start", [float("nan"), float("inf"), -1.0])
def test_start_must_lie_where_commands_are(model: Model, start: float) -> None:
    with pytest.raises(SettingsError, match="the start"):
        predict(model, [[0.0, 1.0, 0.0]], horizon=1.0, start=start)


def test_initial_speed_must_be_finite(model: Model) -> None:
    with pytest.raises(SettingsError, match="the initial speeds"):
        predict(model, [[0.0, 1.0, 0.0]], horizon=1.0, initial=(float("nan"), 0.0))


@pytest.mark.parametrize(("v", "omega"), [(1.0, 0.0), (0.8, 0.5), (-0.5, 1.5), (0.0, -0.7)])
def test_baseline_model_and_vendor_multiplier_are_their_formulas(v: float, omega: float) -> None:
    history = _core.InputHistory(np.zeros(1), np.array([v]), np.zeros(1), np.array([omega]))
    segment = _core.Segment(0.0, 3.0, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    for predictor, rate in (
        (baseline_predictor(Settings()), omega),
        (vendor_predictor(1.875, Settings()), omega / 1.875),
    ):
        at = _core.linearize_segment(
            predictor.posterior(0).motion, predictor.posterior(0).mean, history, segment
        )
        expected = _core.exp(np.array([v, 0.0, rate]) * 3.0).vector()
        assert at.predicted.vector() == pytest.approx(expected, abs=1e-12)


def test_a_horizon_of_years_is_refused(model: Model) -> None:
    with pytest.raises(SettingsError, match=r"a horizon of 1e[+]09 s is too long: give 3600 s at most"):
        predict(model, [[0.0, 1.0, 0.0]], horizon=1e9)


def test_a_side_that_was_never_driven_is_warned_of() -> None:
    one_sided = make_model(replace(named("edd-2"), speed=(0.0, 1.0), yaw_rate=(0.0, 1.0)))
    with pytest.warns(UserWarning, match="yaw rate of -0.500 rad/s is far beyond the 0 rad/s"):
        predict(one_sided, [(0.0, 0.5, -0.5)], horizon=1.0)
    with pytest.warns(UserWarning, match="speed of -0.500 m/s is far beyond the 0 m/s"):
        predict(one_sided, [(0.0, -0.5, 0.5)], horizon=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        predict(one_sided, [(0.0, 1.0, -0.1), (0.5, -0.1, 1.0)], horizon=1.0)


def test_an_axis_that_was_never_driven_is_warned_of() -> None:
    straight = make_model(replace(named("edd-2"), yaw_rate=(0.0, 0.0)))
    with pytest.warns(UserWarning, match="yaw rate of 0.500 rad/s is far beyond the 0 rad/s"):
        predict(straight, [(0.0, 0.5, 0.5)], horizon=1.0)
    span = straight.content.range.model_copy(update={"sideways": (-0.5, 0.5)})
    omni = Model(straight.content.model_copy(update={"range": span}))
    with pytest.warns(UserWarning, match="sideways speed of 2.00 m/s is far beyond the 0.500 m/s"):
        predict(omni, [(0.0, 0.5, 2.0, 0.0)], horizon=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        predict(omni, [(0.0, 0.5, 0.6, 0.01)], horizon=1.0)


def test_speeds_of_no_robot_are_refused(model: Model) -> None:
    with pytest.raises(SettingsError, match=r"the commands reach 1e[+]300, .* m/s and omega in rad/s"):
        predict(model, [[0.0, 1e300, 1e300]], horizon=5.0)
    with pytest.raises(SettingsError, match="the initial speeds reach"):
        predict(model, [[0.0, 1.0, 0.0]], horizon=5.0, initial=(-1e12, 0.0))


SLIDING = {"lon.V": -0.05, "lon.gx": 0.05, "lat.gy": 0.1, "ang.w": -0.2, "ang.gy": 0.05}


def sliding() -> Model:
    return make_model(replace(named("ipem-13"), values=SLIDING))


def test_a_robot_across_a_slope_slides_downhill_and_turns_its_nose_down() -> None:
    inputs = held(np.arange(0.0, 6.0, 0.5), 1.0, 0.0)
    path = predict(sliding(), inputs, horizon=4.0, ground=Grade(0.15, downhill=-np.pi / 2))
    assert path.poses[-1, 1] < -0.3  # downhill is to the right
    assert path.poses[-1, 2] < -0.1
    x, y, z, roll, pitch, yaw = path.poses_in_space[-1].tolist()
    assert z == pytest.approx(np.tan(0.15) * y)
    assert roll > 0.1
    assert pitch > 0.0
    assert (x, y, yaw) == tuple(path.poses[-1].tolist())
    assert {"z", "roll", "pitch"} <= set(path.to_dataframe().columns)


def test_gravity_turns_with_the_heading_on_a_grade_and_so_does_the_path_with_the_grade() -> None:
    inputs = held(np.arange(0.0, 9.0, 0.5), 0.8, 0.6)
    one = predict(sliding(), inputs, horizon=6.0, ground=Grade(0.2, downhill=0.4))
    turned = predict(sliding(), inputs, horizon=6.0, ground=Grade(0.2, downhill=1.6), at=(0.0, 0.0, 1.2))
    assert turned.poses == pytest.approx(one.poses, abs=1e-9)
    assert turned.covariance == pytest.approx(one.covariance, rel=1e-6, abs=1e-12)


def test_a_map_of_a_plane_predicts_what_its_grade_does() -> None:
    grade = Grade(0.15, downhill=-0.7)
    x, y = np.meshgrid(np.arange(-15.0, 15.5, 0.5), np.arange(-15.0, 15.5, 0.5))
    rise = grade.rise(0.0)
    made = ElevationMap(rise[0] * x + rise[1] * y, origin=(-15.0, -15.0), cell=0.5)
    inputs = held(np.arange(0.0, 9.0, 0.5), 0.8, 0.6)
    start = (1.0, -2.0, 0.9)
    on_map = predict(sliding(), inputs, horizon=5.0, ground=made, at=start)
    on_grade = predict(sliding(), inputs, horizon=5.0, ground=grade, at=start)
    assert on_map.poses_in_space == pytest.approx(on_grade.poses_in_space, abs=1e-9)
    assert on_map.covariance == pytest.approx(on_grade.covariance, rel=1e-6, abs=1e-12)


def test_a_path_that_leaves_the_map_and_a_pose_that_is_none_are_refused() -> None:
    made = ElevationMap(np.zeros((5, 5)), origin=(-1.0, -1.0), cell=0.5)
    inputs = held(np.arange(0.0, 9.0, 0.5), 1.0, 0.0)
    with pytest.raises(SettingsError, match="leads beside the map"):
        predict(sliding(), inputs, horizon=5.0, ground=made)
    with pytest.raises(SettingsError, match="must be finite"):
        predict(sliding(), inputs, horizon=1.0, ground=made, at=(0.0, np.nan, 0.0))

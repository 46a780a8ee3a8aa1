# SPDX-License-Identifier: Apache-2.0
"""Rollouts from Python: the poses that `predict` gives, for many commands at once, or a clear error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from planning.planning_samples import sliding
from sample_logs import Drive, simulated_log
from sample_models import LIMITS, Made, make_model

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.errors import SettingsError
from slipwise.ground import Grade
from slipwise.models import Model
from slipwise.planning import Costmap, Start, command_buffer, rollout, sample_futures
from slipwise.prediction import predict

N, K, DT = 20, 30, 0.1


def learned(basis: str) -> Model:
    log = simulated_log(Drive(seconds=40.0, lag=0.2, delay=0.1))
    return calibrate(log, input="command", settings=make_settings({"basis": basis})).model


def responding() -> Model:
    """A model whose actuator has gains and a slow mode, as wheel speeds beside commands teach it."""
    values = {"lat.w": 0.05, "ang.w": -0.3}
    return make_model(Made(basis=_core.named_basis("full-linear-6"), values=values, response=True))


def limited() -> Model:
    """The same behind a dead-band, top speeds and ramps of the commands and of both sides."""
    return make_model(
        Made(
            basis=_core.named_basis("full-linear-6"),
            values={"lat.w": 0.05, "ang.w": -0.3},
            response=True,
            limits=LIMITS,
        )
    )


def direct() -> Model:
    """The same without an actuator model: delays alone, one of which is an offset of clocks."""
    values = {"lat.w": 0.05, "ang.w": -0.3}
    return make_model(Made(_core.named_basis("full-linear-6"), values, delays=(0.13, -0.004)))


@pytest.fixture(scope="module", params=["lag and delay", "response", "limits", "direct"])
def model(request: pytest.FixtureRequest) -> Model:
    if request.param == "limits":
        return limited()
    if request.param == "direct":
        return direct()
    return responding() if request.param == "response" else learned("auto")


@pytest.fixture(scope="module")
def commands() -> NDArray[np.float64]:
    random = np.random.default_rng(5)
    return np.stack((random.uniform(0.3, 1.2, (N, K)), random.uniform(-0.6, 0.6, (N, K))), axis=2)


def poses_of_predict(model: Model, commands: NDArray[np.float64], n: int) -> tuple[Any, Any]:
    """The path of one rollout as `predict` gives it, after standing still for long enough."""
    before = np.arange(-20, 0) * DT
    rows = np.column_stack(
        (np.concatenate((before, np.arange(K) * DT)), np.vstack((np.zeros((20, 2)), commands[n])))
    )
    path = predict(model, rows, horizon=K * DT, start=0.0, initial=(0.0, 0.0))
    return path.poses[1:], path.covariance[1:]


def test_rollouts_are_predictions(model: Model, commands: NDArray[np.float64]) -> None:
    start = Start(past=np.zeros((20, 2)))
    for dtype, tolerance in ((np.float64, 1e-9), (np.float32, 1e-5)):
        path = rollout(model, commands, DT, start=start, dtype=dtype).path
        assert path is not None
        assert path.shape == (3, K, N)
        for n in (0, 7, N - 1):
            expected, _ = poses_of_predict(model, commands, n)
            assert path[:, -1, n] == pytest.approx(expected[-1], abs=tolerance)


def test_covariance_is_that_of_a_prediction_without_pose_noise(
    model: Model, commands: NDArray[np.float64]
) -> None:
    noise = model.content.noise.model_copy(update={"pose_std_xy": 0.0, "pose_std_yaw": 0.0})
    exact = Model(model.content.model_copy(update={"noise": noise}))
    found = rollout(exact, commands, DT, start=Start(past=np.zeros((20, 2))), covariance=True).covariance
    assert found is not None
    assert found.shape == (6, K, N)
    _, expected = poses_of_predict(exact, commands, 3)
    rows, columns = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
    assert found[:, -1, 3] == pytest.approx(expected[-1][rows, columns], rel=0.05, abs=1e-5)


def test_uncertainty_in_float_is_that_in_double(model: Model, commands: NDArray[np.float64]) -> None:
    start = Start(pose=(4e5, 5e6, 0.3), past=np.zeros((20, 2)))
    single, double = (
        rollout(model, commands, DT, start=start, covariance=True, dtype=dtype).covariance
        for dtype in (np.float32, np.float64)
    )
    assert single is not None
    assert double is not None
    assert (single.dtype, double.dtype) == (np.float32, np.float64)
    assert np.abs(single - double).max() < 1e-4 * np.abs(double).max()
    few = commands[:4].astype(np.float32)
    drawn = sample_futures(model, few, DT, samples=3, seed=1)
    assert drawn.dtype == np.float32
    assert drawn == pytest.approx(
        sample_futures(model, few, DT, samples=3, seed=1, dtype=np.float64), abs=1e-4
    )


def test_every_instruction_level_gives_the_same_poses(model: Model, commands: NDArray[np.float64]) -> None:
    levels = _core.instruction_levels()
    assert levels[0] == "portable"
    portable = rollout(model, commands, DT, level="portable").path
    for level in levels:
        assert rollout(model, commands, DT, level=level).path == pytest.approx(portable, abs=1e-10)
    lying_fast = command_buffer(N, K, np.float64)
    lying_fast[:] = commands
    again = rollout(model, lying_fast, DT, level="portable").path
    assert again is not None
    assert portable is not None
    assert again.tobytes() == portable.tobytes()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_gpu_gives_the_poses_of_the_processor(
    model: Model, commands: NDArray[np.float64], dtype: type[np.floating[Any]]
) -> None:
    if reason := _core.why_no_gpu():
        pytest.skip(reason)
    if model.limits is not None:
        with pytest.raises(SettingsError, match="on the processor only"):
            rollout(model, commands, DT, dtype=dtype, device="cuda")
        return
    costmap = Costmap(np.arange(80.0).reshape(8, 10), resolution=0.5, origin=(-1.0, -2.0), outside=200.0)
    expected = rollout(model, commands, DT, outputs=("path", "end", "costs"), costmap=costmap)
    found = rollout(
        model, commands, DT, outputs=("path", "end", "costs"), costmap=costmap, dtype=dtype, device="cuda"
    )
    tolerance = 1e-9 if dtype is np.float64 else 1e-5
    assert found.path == pytest.approx(expected.path, abs=tolerance)
    assert found.end == pytest.approx(expected.end, abs=tolerance)
    if dtype is np.float64:  # in float a pose at a cell's border may fall to the other side
        assert found.costs == pytest.approx(expected.costs, abs=tolerance)


def test_without_a_gpu_the_error_says_why(model: Model, commands: NDArray[np.float64]) -> None:
    reason = _core.why_no_gpu()
    if not reason:
        pytest.skip("there is a GPU")
    with pytest.raises(SettingsError, match="device 'cuda'") as caught:
        rollout(model, commands, DT, device="cuda")
    assert reason in str(caught.value)
    with pytest.raises(ValueError, match="on the processor"):
        _core.Gpu()


def test_buffers_are_filled_again(model: Model, commands: NDArray[np.float64]) -> None:
    first = rollout(model, commands, DT)
    again = rollout(model, 0.5 * commands, DT, out=first)
    assert again.path is first.path
    fresh = rollout(model, 0.5 * commands, DT).path
    assert again.path is not None
    assert fresh is not None
    assert again.path.tobytes() == fresh.tobytes()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"commands": np.zeros((0, 5, 2))}, "at least one rollout"),
        ({"commands": np.zeros((5, 2))}, r"shape \(5, 2\)"),
        ({"commands": "fast"}, "no array of numbers"),
        ({"commands": np.full((2, 3, 2), np.nan)}, "rollout 0 over period 0 is not finite"),
        ({"dt": 0.0}, "must be a positive number of seconds"),
        ({"dt": np.nan}, "must be a positive number of seconds"),
        ({"threads": 0}, "0 threads"),
        ({"dtype": np.int32}, "int32"),
        ({"level": "sse9"}, "unknown instruction level"),
        ({"device": "tpu"}, "unknown device 'tpu'.*cpu, cuda"),
        ({"outputs": ("poses",)}, "unknown output 'poses'"),
        ({"outputs": ("costs",)}, "costs need a costmap"),
        ({"start": Start(pose=np.zeros((3, 3)))}, "3 starts for 20 rollouts"),
        ({"start": Start(pose=(0.0, np.inf, 0.0))}, "pose is not finite"),
        ({"start": Start(drive=(1.0,))}, "drive has shape"),
        ({"start": Start(past=np.zeros(3))}, "past has shape"),
    ],
)
def test_what_cannot_be_rolled_out_is_refused(
    commands: NDArray[np.float64], change: dict[str, Any], words: str
) -> None:
    arguments = {"commands": commands, "dt": DT} | change
    with pytest.raises(SettingsError, match=words):
        rollout(direct(), **arguments)


def test_buffers_of_another_shape_are_refused(model: Model, commands: NDArray[np.float64]) -> None:
    small = rollout(model, commands[:3], DT)
    with pytest.raises(SettingsError, match="array for path has shape"):
        rollout(model, commands, DT, out=small)


def test_rollouts_on_a_grade_are_those_of_predict_from_every_heading() -> None:
    model, grade = sliding(), Grade(0.2, downhill=0.7)
    commands = np.zeros((3, K, 2))
    commands[:, :, 0], commands[:, :, 1] = 0.8, np.array([[-0.5], [0.0], [0.7]])
    yaws = (0.0, 1.0, -2.5)
    start = Start(pose=[(1.0, 2.0, yaw) for yaw in yaws], grade=grade)
    rolled = rollout(model, commands, DT, start=start, covariance=True)
    assert rolled.path is not None
    assert rolled.covariance is not None
    for n, yaw in enumerate(yaws):
        rows = np.column_stack((np.arange(K) * DT, commands[n]))
        path = predict(model, rows, horizon=K * DT, ground=grade, at=(1.0, 2.0, yaw))
        c, s = np.cos(yaw), np.sin(yaw)
        x, y, turned = path.poses[1:].T
        seen = np.array([1.0 + c * x - s * y, 2.0 + s * x + c * y, yaw + turned])
        assert rolled.path[:, :, n] == pytest.approx(seen, abs=1e-4)
        variances = rolled.covariance[(0, 2, 5), -1, n]
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        stated = turn @ (path.covariance[-1] - path.covariance[0]) @ turn.T
        assert variances == pytest.approx(np.diag(stated), rel=0.1)


def test_a_grade_and_a_gravity_at_once_are_refused() -> None:
    start = Start(gravity=(0.1, 0.0), grade=Grade(0.1))
    with pytest.raises(SettingsError, match="not both"):
        rollout(sliding(), np.zeros((1, K, 2)), DT, start=start)

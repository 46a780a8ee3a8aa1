# SPDX-License-Identifier: Apache-2.0
"""From measured speeds the drive goes to its command and not beyond it, in predictions, rollouts, plans."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_models import Made, make_model

from slipwise import _core
from slipwise.models import Model
from slipwise.planning import DriveState, Limits, Planner, Start, TrajectoryOptions, rollout
from slipwise.planning.trajectory import uncertain_path
from slipwise.prediction import predict

Floats = NDArray[np.float64]

NO_SLIP = _core.Basis("none", [], [], [])
LAGS = ((0.02, 0.5), (0.3, 1.5), (0.1, 6.0))  # s, fast and slow
FRACTIONS = (0.0, 0.14, 0.5, 0.95, 1.0)
GAINS = (0.6, 1.0, 1.2)
DELAYS = (0.001, 0.13, 0.4)  # s
PARTS = (0.0, 0.3, 0.8, 1.0)  # of the command, measured at the start
RAMPS = {
    "speed": {"slew_rate_up": 0.8, "slew_rate_down": 1.7},
    "yaw_rate": {"slew_rate_up": 1.3, "slew_rate_down": 0.9},
}


def two_modes(
    lags: tuple[float, float], fraction: float, gain: float, delay: float, limited: bool = False
) -> Model:
    values = {}
    for place in ("v", "omega"):
        values |= {
            f"log_time_constant_{place}": np.log(lags[0]),
            f"log_slow_time_constant_{place}": np.log(lags[1]),
        }
        values |= {
            f"slow_fraction_{place}": fraction,
            f"gain_{place}": gain,
            f"log_delay_{place}": np.log(delay),
        }
    limits = RAMPS if limited else None
    return make_model(Made(NO_SLIP, values, commands=True, response=True, limits=limits))


def speeds(poses: Floats, period: float) -> Floats:
    """Mean speeds between poses of a straight drive, [N]."""
    return np.diff(poses[:, 0]) / period


def check_law(speed: Floats, command: float, gain: float, part: float) -> None:
    low, high = sorted((0.0, gain * command))
    assert speed.min() >= low - 1e-9
    assert speed.max() <= high + 1e-9
    if part == 1.0:
        assert speed == pytest.approx(np.full(len(speed), gain * command), abs=1e-9)


MODELS = list(product(LAGS, FRACTIONS, GAINS, DELAYS))


def test_rollouts_keep_the_law(subtests: pytest.Subtests) -> None:
    for limited in [False, True]:
        for command in [1.0, -0.7]:
            for sent in [0, 1, 14]:
                with subtests.test(limited=limited, command=command, sent=sent):
                    past = np.tile([command, 0.0], (sent, 1)) if sent else None
                    for lags, fraction, gain, delay in MODELS[::13]:
                        model = two_modes(lags, fraction, gain, delay, limited)
                        for part in PARTS:
                            start = Start(drive=(part * gain * command, 0.0), past=past)
                            path = rollout(model, np.tile([command, 0.0], (1, 40, 1)), 0.05, start=start).path
                            assert path is not None
                            poses = np.vstack((np.zeros((1, 3)), path[:, :, 0].T))
                            check_law(speeds(poses, 0.05), command, gain, part)


@pytest.mark.parametrize(("sent", "limited"), [(0, False), (3, False), (14, False), (0, True)])
def test_rollouts_start_as_predictions_do(sent: int, limited: bool) -> None:
    rng = np.random.default_rng(1)
    model = two_modes((0.3, 1.5), 0.4, 0.8, 0.13, limited)
    given = rng.uniform(-0.5, 1.0, (sent + 40, 2))
    start = Start(drive=(0.6, 0.2), past=given[:sent] if sent else None)
    path = rollout(model, given[None, sent:], 0.05, start=start).path
    assert path is not None
    rows = np.column_stack((0.05 * np.arange(-sent, 40), given))
    rows = np.vstack(([-1e3, *given[0]], rows)) if sent else rows  # what is older equals the oldest
    expected = predict(model, rows, horizon=2.0, start=0.0, initial=(0.6, 0.2))
    assert pytest.approx(expected.poses[1:], abs=2e-4 if limited else 1e-9) == path[:, 1::2, 0].T


def test_what_a_planner_starts_with_goes_to_its_command() -> None:
    model = two_modes((0.3, 1.5), 0.4, 1.0, 0.2)
    state = DriveState(drive=(0.7, 0.0), commanded=(0.7, 0.0))
    options = TrajectoryOptions(cruise=0.7, end_speed=0.7)
    plan = Planner(model, limits=Limits(1.0, 1.0, 1.0), options=options).to((5.0, 0.0, 0.0), state=state)
    step = np.diff(plan.t)
    moved = np.diff(plan.poses[:, 0])[step > 1e-6] / step[step > 1e-6]
    assert moved == pytest.approx(np.full(len(moved), 0.7), abs=0.01)
    assert uncertain_path(model, plan, state=state).poses[-1] == pytest.approx(plan.poses[-1], abs=1e-3)


def test_the_case_of_the_two_commands() -> None:
    model = two_modes((0.05, 3.0), 0.14, 1.0, 0.1)
    path = predict(model, [(0.0, 1.0, 0.3), (2.0, 1.0, -0.3)], horizon=5.0, initial=(0.8, 0.1))
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() <= 0.1 + 1e-9


@pytest.mark.parametrize("delay", [0.001, 0.3])
def test_a_measured_speed_that_contradicts_the_history_is_not_overtaken(delay: float) -> None:
    """Commanded 0.5 m/s for long, measured at 1 m/s, commanded 1 m/s from now on."""
    for lags, fraction in product((*LAGS, (0.1, 9.0)), (0.05, *FRACTIONS)):
        model = two_modes(lags, fraction, 1.0, delay)
        path = predict(
            model, [(-60.0, 0.5, 0.0), (0.0, 1.0, 0.0)], horizon=5.0, start=0.0, initial=(1.0, 0.0)
        )
        start = Start(drive=(1.0, 0.0), past=np.tile([0.5, 0.0], (20, 1)))
        batch = rollout(model, np.tile([1.0, 0.0], (1, 50, 1)), 0.1, start=start).path
        assert batch is not None
        for poses in (path.poses, np.vstack((np.zeros((1, 3)), batch[:, :, 0].T))):
            assert speeds(poses, 0.1).max() <= 1.0 + 1e-9
            assert poses[-1, 0] <= 5.0 + 1e-9


def test_without_measured_speeds_the_robot_starts_at_rest() -> None:
    model = two_modes((0.3, 1.5), 0.4, 0.8, 0.2)
    commands = [(0.0, 1.0, 0.3)]
    path = predict(model, commands, horizon=3.0)
    at_rest = predict(model, commands, horizon=3.0, initial=(0.0, 0.0))
    assert not path.poses[:3].any()
    assert path.poses == pytest.approx(at_rest.poses, abs=1e-12)

# SPDX-License-Identifier: Apache-2.0
"""A simulation gives the log that a robot would have recorded, the same for the same seed."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_sim import LandTamer, Scenario, Simulation, Truth, hold, simulate, thesis_drive

SHORT = Scenario(duration=8.0)


def column_bytes(simulation: Simulation) -> bytes:
    run = simulation.log.runs[0]
    parts = [getattr(simulation.truth, field.name) for field in fields(Truth)]
    for series in (run.commands, run.wheels, run.poses):
        assert series is not None
        columns = (getattr(series, field.name) for field in fields(series))
        parts += [column for column in columns if column is not None]
    return b"".join(part.tobytes() for part in parts if isinstance(part, np.ndarray))


@pytest.fixture(scope="module")
def minute() -> Simulation:
    return simulate(Scenario(duration=60.0), seed=11)


@pytest.mark.parametrize("terrain", ["tyre-force", "traction-law", "contact-friction"])
def test_same_seed_gives_the_same_bytes(terrain: str) -> None:
    scenario = replace(SHORT, terrain=terrain)
    assert column_bytes(simulate(scenario, seed=4)) == column_bytes(simulate(scenario, seed=4))


def test_another_seed_gives_another_drive_and_other_noise() -> None:
    first, second = simulate(SHORT, seed=1), simulate(SHORT, seed=2)
    assert not np.array_equal(first.truth.x, second.truth.x)
    noise, other_noise = (run.log.runs[0].poses.x - run.truth.x for run in (first, second))
    assert abs(np.corrcoef(noise, other_noise)[0, 1]) < 0.3


def test_noise_has_the_stated_size_and_is_white(minute: Simulation) -> None:
    poses, truth = minute.log.runs[0].poses, minute.truth
    yaw_error = np.angle(np.exp(1j * (poses.yaw - truth.yaw)))
    for error, std in ((poses.x - truth.x, 0.01), (poses.y - truth.y, 0.01), (yaw_error, 0.003)):
        assert error.std() == pytest.approx(std, rel=0.08)
        assert abs(error.mean()) < 4 * std / np.sqrt(error.size)
        assert abs(np.corrcoef(error[1:], error[:-1])[0, 1]) < 4 / np.sqrt(error.size)


def test_heading_is_wrapped_as_measured(minute: Simulation) -> None:
    assert np.ptp(minute.truth.yaw) > np.pi
    assert np.abs(minute.log.runs[0].poses.yaw).max() <= np.pi


def test_poses_state_their_noise(minute: Simulation) -> None:
    poses = minute.log.runs[0].poses
    assert poses.std_xy is not None
    assert poses.std_yaw is not None
    assert set(poses.std_xy) == {0.01}
    assert set(poses.std_yaw) == {0.003}


def test_noiseless_scenario_measures_the_truth() -> None:
    simulation = simulate(replace(SHORT, std_xy=0.0, std_yaw=0.0), seed=0)
    np.testing.assert_array_equal(simulation.log.runs[0].poses.x, simulation.truth.x)
    np.testing.assert_allclose(simulation.log.runs[0].poses.yaw, simulation.truth.yaw, atol=1e-12)


def test_log_holds_commands_wheels_and_poses_at_20_hz(minute: Simulation) -> None:
    (run,) = minute.log.runs
    assert run.commands is not None
    assert run.wheels is not None
    assert (len(run.commands), len(run.wheels), len(run.poses)) == (1200, 1201, 1201)
    np.testing.assert_allclose(np.diff(run.poses.t), 0.05, atol=1e-12)
    assert minute.log.notes == ("simulated: tyre-force terrain, 60 s, seed 11",)


def test_wheel_twist_is_that_of_the_true_wheel_speeds(minute: Simulation) -> None:
    wheels, vehicle = minute.log.runs[0].wheels, LandTamer()
    assert wheels is not None
    sides = vehicle.side_rates(wheels.v, wheels.omega)
    np.testing.assert_allclose(sides[:, 0], minute.truth.wheel_left, atol=1e-12)
    np.testing.assert_allclose(sides[:, 1], minute.truth.wheel_right, atol=1e-12)


def test_scripted_commands_are_logged_as_given(minute: Simulation) -> None:
    commands, script = minute.log.runs[0].commands, thesis_drive(11, 60.0)
    assert commands is not None
    np.testing.assert_array_equal(commands.v, script.v)
    np.testing.assert_array_equal(commands.omega, script.omega)


def test_own_commands_replace_the_script() -> None:
    commands = hold(0.8, 0.0, 5.0)
    simulation = simulate(Scenario(duration=5.0, commands=commands), seed=0)
    assert simulation.log.runs[0].commands is commands
    assert simulation.truth.wheel_left[-1] == pytest.approx(0.8 / 0.3, rel=0.02)


def test_late_poses_have_late_stamps_and_the_same_places() -> None:
    prompt, late = simulate(SHORT, seed=3), simulate(replace(SHORT, pose_delay=0.12), seed=3)
    np.testing.assert_allclose(late.log.runs[0].poses.t - prompt.log.runs[0].poses.t, 0.12, atol=1e-12)
    np.testing.assert_array_equal(late.log.runs[0].poses.x, prompt.log.runs[0].poses.x)
    np.testing.assert_array_equal(late.truth.t, prompt.truth.t)


def test_senseless_scenario_is_refused(subtests: pytest.Subtests) -> None:
    for change, message in [
        ({"duration": -1.0}, "duration is -1.0"),
        ({"duration": float("nan")}, "duration is nan"),
        ({"duration": 1e9}, "duration is 1000000000.0"),
        ({"pose_rate": 0.0}, "pose_rate is 0.0"),
        ({"pose_rate": 1e9}, r"pose_rate is 1000000000.0 .*give 0\.1 to 1000 Hz"),
        ({"pose_rate": 1e-300}, "pose_rate is 1e-300"),
        ({"pose_delay": 1e300}, "pose_delay is 1e"),
        ({"std_xy": -0.01}, "std_xy is -0.01"),
        ({"std_yaw": float("inf")}, "std_yaw is inf"),
        ({"pose_delay": float("nan")}, "pose_delay is nan"),
        ({"terrain": "ice"}, "unknown terrain 'ice'.*tyre-force, traction-law, contact-friction"),
        ({"drive": "rally"}, "unknown drive 'rally'.*thesis, steps, dull"),
    ]:
        with subtests.test(change=change, message=message), pytest.raises(SettingsError, match=message):
            simulate(replace(SHORT, **change), seed=0)  # type: ignore[arg-type]


def test_empty_commands_are_refused() -> None:
    none = hold(1.0, 0.0, 1.0).select(slice(0))
    with pytest.raises(SettingsError, match="no commands"):
        simulate(replace(SHORT, commands=none), seed=0)


def test_negative_seed_is_refused() -> None:
    with pytest.raises(SettingsError, match="seed is -1"):
        simulate(SHORT, seed=-1)

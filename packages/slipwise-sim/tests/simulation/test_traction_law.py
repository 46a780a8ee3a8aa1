# SPDX-License-Identifier: Apache-2.0
"""The traction law is (2.8) and (2.9) as printed, smooth, symmetric, and never a source of energy."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise_sim.traction_law import TractionLaw, traction_force

LAW = TractionLaw()
LOAD = np.full(1000, 1600.0)


def random_states() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.Generator(np.random.PCG64(7))
    return rng.uniform(-2, 2, (2, LOAD.size)), rng.uniform(-2, 2, LOAD.size)


def straight(forward: np.ndarray, rim: np.ndarray, law: TractionLaw = LAW) -> np.ndarray:
    """Forward force over load of wheels that do not slide sideways."""
    load = np.full(forward.shape, 1000.0)
    return traction_force(law, load, np.stack([forward, np.zeros_like(forward)]), rim)[0] / 1000.0


def test_straight_driving_feels_the_law_as_printed() -> None:
    forward, rim = random_states()[0][0], random_states()[1]
    relative, ahead = rim - forward, np.abs(forward)
    traction = (
        np.sign(relative) * LAW.traction * (1 - np.exp(-LAW.traction_rate * np.abs(relative)))
        + LAW.traction_slope * relative
    )
    resistance = -np.sign(forward) * (
        LAW.rolling * (1 - np.exp(-LAW.rolling_rate * ahead)) + LAW.rolling_slope * ahead
    )
    np.testing.assert_allclose(straight(forward, rim), traction + resistance, rtol=1e-12, atol=1e-12)


def test_wheel_at_rest_feels_no_force() -> None:
    force = traction_force(LAW, LOAD, np.zeros((2, LOAD.size)), np.zeros(LOAD.size))
    assert np.array_equal(force, np.zeros((2, LOAD.size)))


def test_law_is_smooth_where_sliding_and_rolling_change_their_sign() -> None:
    """Slopes on both sides of zero are those of the exponentials at zero."""
    law = TractionLaw(rolling=0.0, rolling_slope=0.0)
    step, slope = 1e-7, law.traction * law.traction_rate + law.traction_slope
    for sign in (1.0, -1.0):
        sliding = straight(np.array([1.0]), np.array([1.0 + sign * step]), law)
        assert sliding[0] / (sign * step) == pytest.approx(slope, rel=1e-5)
    slope = LAW.rolling * LAW.rolling_rate + LAW.rolling_slope
    for sign in (1.0, -1.0):
        rolling = straight(np.array([sign * step]), np.array([sign * step]))
        assert rolling[0] / (-sign * step) == pytest.approx(slope, rel=1e-5)


def test_sideways_sliding_is_held_as_forward_sliding_is() -> None:
    law = TractionLaw(rolling=0.0, rolling_slope=0.0)
    load, rim = np.array([1000.0]), np.array([0.0])
    forward = traction_force(law, load, np.array([[0.3], [0.0]]), rim)
    sideways = traction_force(law, load, np.array([[0.0], [0.3]]), rim)
    np.testing.assert_allclose(sideways, forward[::-1], atol=1e-12)
    assert forward[0, 0] < -500.0


def test_ground_never_gives_energy() -> None:
    velocity, rim_speed = random_states()
    no_rolling = TractionLaw(rolling=0.0, rolling_slope=0.0)
    sliding = velocity - np.stack([rim_speed, np.zeros_like(rim_speed)])
    traction = traction_force(no_rolling, LOAD, velocity, rim_speed)
    resistance = traction_force(LAW, LOAD, velocity, rim_speed) - traction
    assert np.all((traction * sliding).sum(axis=0) < 0)
    assert np.all(resistance[0] * velocity[0] < 0)
    np.testing.assert_array_equal(resistance[1], 0.0)


def test_unloaded_wheel_feels_no_force() -> None:
    assert not traction_force(LAW, 0 * LOAD, *random_states()).any()

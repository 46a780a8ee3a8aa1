# SPDX-License-Identifier: Apache-2.0
"""Held-out predictions are scored without whole turns, and their covariance follows earlier errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dynamics.sample_systems import CART, MEASURED, ride

from slipwise.dynamics import State, learn_dynamics


def test_an_angle_that_wraps_is_no_error() -> None:
    states = (State("yaw", "rad", measured=MEASURED, angle=True), CART.states[1])
    made = ride(1)
    wrapped = made.measurements.copy()
    wrapped[:, 1] = np.arctan2(np.sin(wrapped[:, 1]), np.cos(wrapped[:, 1]))
    assert np.ptp(made.measurements[:, 1]) > 2.0 * np.pi
    turned = learn_dynamics(replace(CART, states=states), made.inputs, wrapped)
    straight = learn_dynamics(CART, made.inputs, made.measurements)
    assert turned.scores[-1].error == pytest.approx(straight.scores[-1].error, rel=1e-6)


def test_a_covariance_that_is_too_small_is_inflated_by_earlier_errors() -> None:
    states = (replace(CART.states[0], measured=MEASURED / 4.0), CART.states[1])
    made = ride(2, seconds=80.0)
    learned = learn_dynamics(replace(CART, states=states), made.inputs, made.measurements, horizons=(0.2,))
    assert learned.scores[0].inflation > 2.0
    assert learned.scores[0].nis == pytest.approx(1.0, abs=0.6)


def test_a_drive_shorter_than_two_horizons_is_not_judged() -> None:
    made = ride(3, seconds=8.0)
    learned = learn_dynamics(CART, made.inputs, made.measurements, horizons=(5.0,))
    assert learned.scores == ()
    assert not learned.good
    assert "too short to judge" in learned.verdict

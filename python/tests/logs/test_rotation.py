# SPDX-License-Identifier: Apache-2.0
"""Tests of quaternions: angles and back, products, and bad ones."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slipwise.logs.rotation import angles_of, product, quaternions_of, rotate, unit_quaternions

ANGLE = st.floats(-3.1, 3.1)
PITCH = st.floats(-1.5, 1.5)


@given(ANGLE, PITCH, ANGLE)
def test_angles_survive_a_quaternion(roll: float, pitch: float, yaw: float) -> None:
    q = quaternions_of(np.array([roll]), np.array([pitch]), np.array([yaw]))
    np.testing.assert_allclose(np.concatenate(angles_of(q)), [roll, pitch, yaw], atol=1e-9)


@given(ANGLE, ANGLE, PITCH)
def test_a_product_rotates_by_one_then_the_other(a: float, b: float, pitch: float) -> None:
    zero = np.zeros(1)
    first = quaternions_of(zero, np.array([pitch]), np.array([a]))
    second = quaternions_of(np.array([b]), zero, zero)
    point = np.array([[1.0, 2.0, 3.0]])
    np.testing.assert_allclose(
        rotate(product(first, second), point), rotate(first, rotate(second, point)), atol=1e-12
    )


def test_yaw_turns_x_to_y() -> None:
    q = quaternions_of(np.zeros(1), np.zeros(1), np.array([0.5 * np.pi]))
    np.testing.assert_allclose(rotate(q, np.array([[1.0, 0.0, 0.0]])), [[0.0, 1.0, 0.0]], atol=1e-15)


def test_quaternions_off_by_more_than_a_hundredth_are_bad() -> None:
    q = np.array([[0, 0, 0, 1.0], [0, 0, 0, 1.005], [0, 0, 0, 1.02], [0, 0, 0, 0.0]])
    unit, good = unit_quaternions(q)
    assert good.tolist() == [True, True, False, False]
    np.testing.assert_allclose(unit[1], [0, 0, 0, 1.0])

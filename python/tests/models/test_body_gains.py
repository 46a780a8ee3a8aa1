# SPDX-License-Identifier: Apache-2.0
"""How the body moves for what the drive does, and straight lines through that."""

from dataclasses import replace

import numpy as np
from sample_models import make_model, named

from slipwise.models.body_gains import BodyTwists, body_twists, turning_twists

MADE = replace(named("edd-2", lon__V=-0.1, ang__w=-0.4), speed=(-0.5, 1.5), yaw_rate=(-1.0, 1.0))


def test_the_body_does_what_is_left_of_the_drive() -> None:
    body = body_twists(make_model(MADE))
    np.testing.assert_allclose(body.mean[:, 0], 0.9 * body.v, atol=1e-15)
    np.testing.assert_allclose(body.mean[:, 1], 0.0, atol=1e-15)
    np.testing.assert_allclose(body.mean[:, 2], 0.6 * body.w, atol=1e-15)
    assert (body.v.min(), body.v.max()) == (-0.5, 1.5)
    assert (body.w.min(), body.w.max()) == (-1.0, 1.0)


def test_the_line_through_a_straight_drive_is_its_gain_and_knows_its_derivative() -> None:
    body = body_twists(make_model(MADE))
    gain, by_parameter = body.line(2, body.w)
    np.testing.assert_allclose(gain, [0.6])
    np.testing.assert_allclose(by_parameter, [[0.0, 1.0]], atol=1e-12)


def test_an_input_that_is_always_zero_has_no_gain() -> None:
    none = np.zeros(5)
    gain, by_parameter = BodyTwists(none, none, none, np.ones((5, 3)), np.ones((5, 3, 2))).line(0, none)
    assert not gain.any()
    assert not by_parameter.any()


def test_turning_at_a_radius_goes_to_both_sides_as_fast_as_the_log_went() -> None:
    for radius, fastest in ((0.5, 0.5), (4.0, 1.5)):  # the yaw rate ends the one, the speed the other
        body = turning_twists(make_model(MADE), radius)
        np.testing.assert_allclose(np.abs(body.w) * radius, body.v)
        assert body.v.max() == fastest
        assert body.w.max() == -body.w.min()

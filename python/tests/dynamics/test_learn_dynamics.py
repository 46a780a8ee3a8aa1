# SPDX-License-Identifier: Apache-2.0
"""Parameters of a user's dynamics are learned with deviations that hold; what is not seen is said to be."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dynamics.sample_systems import CART, ride

from slipwise.dynamics import Parameter, learn_dynamics
from slipwise.errors import SettingsError


def test_a_ride_gives_parameters_within_three_sigma_and_predictions_better_than_given() -> None:
    made = ride(1)
    learned = learn_dynamics(CART, made.inputs, made.measurements)
    for parameter, truth in zip(learned.parameters, made.truth, strict=True):
        assert parameter.identified
        assert abs(parameter.value - truth) < 3.0 * parameter.std
    assert [score.horizon for score in learned.scores] == [1.0, 2.0, 5.0]
    assert learned.scores[-1].ratio < 1.0
    assert learned.good
    assert learned.rejected == 0
    assert learned.course.shape == (len(made.measurements) - 1, 5)


def test_jacobians_of_a_user_give_the_same_as_differences() -> None:
    made = ride(2, seconds=10.0)

    def jacobians(state: Any, inputs: Any, parameters: Any) -> Any:
        return (
            np.array([[0.0, 1.0], [0.0, -parameters[0]]]),
            np.array([[0.0, 0.0], [-state[1], inputs[0]]]),
        )

    plain = learn_dynamics(CART, made.inputs, made.measurements)
    exact = learn_dynamics(replace(CART, jacobians=jacobians), made.inputs, made.measurements)
    assert exact.estimate.mean == pytest.approx(plain.estimate.mean, abs=1e-7)
    wrong = replace(CART, jacobians=lambda _s, _u, _p: (np.eye(3), np.eye(2)))
    with pytest.raises(SettingsError, match="the Jacobian by the state must be an array of 2 x 2"):
        learn_dynamics(wrong, made.inputs, made.measurements)


def test_a_parameter_that_cannot_be_seen_is_said_to_be_and_its_value_is_not_handed_on(tmp_path: Path) -> None:
    made = ride(3, force=0.0)
    learned = learn_dynamics(CART, made.inputs, made.measurements)
    assert not learned["gain"].identified
    assert re.search("does not determine .*gain: do not use", learned.verdict)
    text = learned.save(tmp_path / "cart.yaml").read_text(encoding="utf-8")
    assert "identified: false" in text


def test_parameters_that_do_the_same_are_said_to_be_confounded() -> None:
    twins = (Parameter("a", 0.5, 0.3), Parameter("b", 0.5, 0.3))
    both = replace(CART, parameters=twins, rates=lambda s, u, p: (s[1], (p[0] + p[1]) * u[0] - 0.5 * s[1]))
    made = ride(4)
    learned = learn_dynamics(both, made.inputs, made.measurements)
    assert "a and b can hardly be distinguished" in learned.verdict


def test_what_is_measured_after_a_prediction_began_does_not_reach_it() -> None:
    made = ride(5, seconds=20.0)
    later = made.measurements.copy()
    later[150:, 1] += 0.5
    plain = learn_dynamics(CART, made.inputs, made.measurements, horizons=(1.0,))
    moved = learn_dynamics(CART, made.inputs, later, horizons=(1.0,))
    assert (plain.course[:149] == moved.course[:149]).all()


@pytest.mark.parametrize("horizons", [(), (0.0,), (float("nan"),)])
def test_horizons_that_make_no_sense_are_refused(horizons: tuple[float, ...]) -> None:
    made = ride(6, seconds=5.0)
    with pytest.raises(SettingsError, match="horizons must be positive"):
        learn_dynamics(CART, made.inputs, made.measurements, horizons=horizons)


def test_an_error_of_the_user_s_function_is_the_user_s() -> None:
    made = ride(6, seconds=5.0)
    broken = replace(CART, rates=lambda _s, _u, _p: {}["speed"])
    with pytest.raises(KeyError, match="speed"):
        learn_dynamics(broken, made.inputs, made.measurements)


def test_dynamics_that_run_away_are_said_to() -> None:
    made = ride(6, seconds=5.0)
    away = replace(CART, rates=lambda s, _u, p: (s[1], p[0] * np.exp(50.0 * (1.0 + s[0] ** 2))))
    with pytest.raises(SettingsError, match="not finite"):
        learn_dynamics(away, made.inputs, made.measurements)


def test_deviations_are_those_that_allow_for_errors_that_last() -> None:
    """That they hold over many rides is shown of the core's filter, in test_dynamics_filter.cpp."""
    white, lasting = (ride(100, colour=colour) for colour in (0.0, 1.0))
    variances = [
        np.diag(learn_dynamics(CART, made.inputs, made.measurements, horizons=(5.0,)).estimate.covariance)
        for made in (white, lasting)
    ]
    assert (variances[1] > 1.3 * variances[0]).all()

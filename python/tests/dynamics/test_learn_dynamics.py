# SPDX-License-Identifier: Apache-2.0
"""Parameters of a user's dynamics are learned with deviations that hold; what is not seen is said to be."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dynamics.sample_systems import CART, ride

from slipwise.dynamics import Parameter, learn_dynamics
from slipwise.errors import SettingsError

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


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


@pytest.mark.slow
@pytest.mark.parametrize(("colour", "least", "most"), [(0.0, 1.3, 2.8), (1.0, 1.0, 3.4)])
def test_deviations_hold_over_simulated_rides_with_white_and_with_correlated_noise(
    colour: float, least: float, most: float
) -> None:
    squared = []
    for seed in range(40):
        made = ride(100 + seed, colour=colour)
        known = learn_dynamics(CART, made.inputs, made.measurements, horizons=(5.0,)).estimate
        error = known.mean - np.array(made.truth)
        squared.append(error @ np.linalg.solve(known.covariance, error))
    # Two parameters: the mean lies between 1.4 and 2.6 with 95 % where the covariance is true.
    assert least < np.mean(squared) < most


@pytest.mark.slow
def test_the_boat_of_the_example_is_recovered_within_three_sigma(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(EXAMPLES))
    boat = __import__("09_boat")
    try:
        inputs, poses = boat.simulated_drive(seed=7)
        learned = learn_dynamics(boat.BOAT, inputs, poses)
    finally:
        sys.modules.pop("09_boat")
    for parameter, truth in zip(learned.parameters, boat.TRUTH, strict=True):
        assert parameter.identified
        assert abs(parameter.value - truth) < 3.0 * parameter.std
    assert learned.scores[-1].ratio < 0.2
    assert learned.scores[-1].nis < 2.0

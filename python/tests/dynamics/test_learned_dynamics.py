# SPDX-License-Identifier: Apache-2.0
"""What was learned predicts with its covariance, and says in words what it is worth."""

from __future__ import annotations

import numpy as np
import pytest
from dynamics.sample_systems import CART, ride

from slipwise.dynamics import LearnedDynamics, learn_dynamics
from slipwise.errors import SettingsError


@pytest.fixture(scope="module")
def learned() -> LearnedDynamics:
    made = ride(1, seconds=20.0)
    return learn_dynamics(CART, made.inputs, made.measurements)


def test_a_prediction_follows_the_learned_parameters(learned: LearnedDynamics) -> None:
    path = learned.predict([[0.0, 0.0]], [0.5, 1.0], state=(0.0, 1.0))
    drag = learned["drag"].value
    assert path.t.tolist() == [0.5, 1.0]
    assert path.states[:, 1] == pytest.approx(np.exp(-drag * path.t), rel=1e-4)
    assert path.covariance[1, 0, 0] > path.covariance[0, 0, 0] > 0.0


def test_without_a_state_it_goes_on_from_the_end_of_the_drive(learned: LearnedDynamics) -> None:
    path = learned.predict([[0.0, 0.0]], [0.0])
    assert path.states[0] == pytest.approx(learned.state.mean)


def test_what_cannot_be_predicted_is_refused(learned: LearnedDynamics, subtests: pytest.Subtests) -> None:
    for inputs, times, state, message in [
        ([[0.0]], [1.0], None, "the inputs have shape"),
        ([[0.0, 1.0]], [1.0], (0.0,), "a state of shape"),
        ([[0.0, 1.0]], [-1.0], None, "not before the last measurement"),
        ([[0.0, np.nan]], [1.0], None, "not finite"),
        ([[0.5, 1.0]], [1.0], None, "there is no input yet"),
    ]:
        with (
            subtests.test(inputs=inputs, times=times, state=state, message=message),
            pytest.raises(SettingsError, match=message),
        ):
            learned.predict(inputs, times, state=state)  # type: ignore[arg-type]


def test_it_is_shown_as_a_table_with_a_verdict(learned: LearnedDynamics) -> None:
    text = str(learned)
    assert text.splitlines()[0].split() == ["parameter", "value", "std", "prior", "identified"]
    assert learned.verdict in text
    assert "after 5 s" in text
    assert repr(learned) == "<LearnedDynamics: 2 of 2 parameters identified>"
    assert learned._repr_html_().startswith("<pre>parameter")
    with pytest.raises(KeyError):
        learned["mass"]

# SPDX-License-Identifier: Apache-2.0
"""What a user says of a system is checked, and reaches the core as it was said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dynamics.sample_systems import CART

from slipwise.dynamics import Dynamics, Parameter, State
from slipwise.errors import SettingsError


def test_measured_states_are_named_in_their_order() -> None:
    assert CART.measured == (0,)
    assert CART.measured_names == ("place",)


def test_what_makes_no_sense_is_refused(subtests: pytest.Subtests) -> None:
    for make, message in [
        (lambda: State("x", measured=0.0), "measured without any error"),
        (lambda: State("x", noise=-1.0), "negative or not finite"),
        (lambda: State("x", start=float("nan")), "x has a number"),
        (lambda: Parameter("a", 1.0, 0.0), "a deviation of 0"),
        (lambda: Parameter("a", float("inf"), 1.0), "begins at inf"),
        (lambda: replace(CART, parameters=()), "need a parameter"),
        (lambda: replace(CART, states=(State("a"), State("b"))), "a state that is measured"),
        (lambda: replace(CART, inputs=("place",)), "two of the names are the same"),
        (lambda: replace(CART, longest_step=0.0), "longest step"),
    ]:
        with subtests.test(make=make, message=message), pytest.raises(SettingsError, match=message):
            make()


def test_rates_of_another_number_are_refused() -> None:
    wrong = Dynamics(CART.states, CART.inputs, CART.parameters, lambda _s, _u, _p: (0.0,))
    with pytest.raises(SettingsError, match="1 rates for 2 states"):
        wrong._rates_in_core(np.zeros((2, 3)), np.zeros(1), np.zeros((2, 3)))


def test_constant_rates_stand_for_all_states_at_once() -> None:
    still = Dynamics(CART.states, CART.inputs, CART.parameters, lambda s, _u, _p: (s[1], 0.0))
    found = still._rates_in_core(np.array([[0.0, 1.0], [2.0, 3.0]]), np.zeros(1), np.zeros((2, 2)))
    assert found.tolist() == [[2.0, 3.0], [0.0, 0.0]]

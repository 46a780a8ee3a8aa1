# SPDX-License-Identifier: Apache-2.0
"""Small networks learn curves, abstain where there is nothing to learn, and say what is missing."""

import sys

import numpy as np
import pytest
from network import NetworkOptions, fit_network

from slipwise.errors import SettingsError

SMALL = NetworkOptions(hidden=(12,), members=2, weight_decays=(0.01, 1.0), iterations=100)
CAUTIOUS = NetworkOptions(hidden=(12,), members=2, weight_decays=(0.01, 1.0), iterations=60, may_abstain=True)


def examples(count: int, *, noise: float, curve: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    inputs = np.column_stack((rng.uniform(-1.0, 1.0, (count, 2)), np.full(count, 3.0)))
    outputs = curve * np.column_stack((inputs[:, 0] ** 2, inputs[:, 0] * inputs[:, 1], np.sin(inputs[:, 1])))
    return inputs, outputs + rng.normal(0.0, noise, outputs.shape)


@pytest.fixture(autouse=True)
def _scikit_learn() -> None:
    pytest.importorskip("sklearn", reason="neural networks need scikit-learn")


def test_a_curve_is_learned_and_a_constant_input_is_left_out() -> None:
    inputs, outputs = examples(200, noise=0.01, curve=1.0)
    network = fit_network(inputs, outputs, SMALL)
    new = np.array([[0.5, -0.5, 3.0], [0.2, 0.7, 8.0]])  # the constant changes: nothing was learned of it
    wanted = np.column_stack((new[:, 0] ** 2, new[:, 0] * new[:, 1], np.sin(new[:, 1])))
    assert np.abs(network.predict(new) - wanted).max() < 0.1
    assert network.used.tolist() == [True, True, False]
    assert network.weight_decay in SMALL.weight_decays
    assert network.validation.shape == (50, 3)


def test_noise_alone_makes_it_abstain_and_a_curve_does_not() -> None:
    nothing = fit_network(*examples(80, noise=0.1, curve=0.0), CAUTIOUS)
    something = fit_network(*examples(80, noise=0.01, curve=1.0), CAUTIOUS)
    assert nothing.weight_decay is None
    assert (nothing.predict(np.ones((3, 3))) == 0.0).all()
    assert something.weight_decay is not None


def test_units_of_outputs_do_not_matter() -> None:
    inputs, outputs = examples(60, noise=0.01, curve=1.0)
    one, other = fit_network(inputs, outputs, SMALL), fit_network(inputs, 1024.0 * outputs, SMALL)
    np.testing.assert_allclose(1024.0 * one.predict(inputs), other.predict(inputs), rtol=1e-6)


def test_inputs_that_never_vary_teach_nothing() -> None:
    network = fit_network(np.ones((12, 2)), np.arange(36.0).reshape(12, 3), SMALL)
    assert network.weight_decay is None
    assert network.predict(np.ones((1, 2))).shape == (1, 3)


def test_without_scikit_learn_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.neural_network", None)
    with pytest.raises(SettingsError, match=r"pip install 'scikit-learn"):
        fit_network(*examples(20, noise=0.1, curve=1.0), SMALL)

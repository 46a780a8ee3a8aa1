# SPDX-License-Identifier: Apache-2.0
"""An ensemble of small neural networks, their weight decay chosen on the last quarter of the examples."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class NetworkOptions:
    """How networks are made: tanh layers, L-BFGS, and what may be chosen."""

    hidden: tuple[int, ...] = (32, 32)
    members: int = 3
    weight_decays: tuple[float, ...] = (0.01, 0.1, 1.0, 10.0)  # of all weights; divided by the examples
    iterations: int = 150  # of L-BFGS, at most
    may_abstain: bool = False  # give zeros where no weight decay predicts the last quarter better
    least_gain: float = 0.02  # of the error there, for giving anything but zeros


@dataclass(frozen=True, eq=False)
class Network:
    """What was learned from examples; it gives zeros where it has no members."""

    weight_decay: float | None  # None: it abstains
    members: tuple[Any, ...]
    validation: Floats  # [M, K] errors on the last quarter, which they were not fitted to
    used: NDArray[np.bool_]  # [D] inputs that vary
    centre: Floats  # [D]
    scale: Floats  # [D]
    output_scale: Floats  # [K]

    def predict(self, inputs: Floats) -> Floats:
        """Return the mean of the members at inputs [N, D], [N, K]."""
        if not self.members or not len(inputs):
            return np.zeros((len(inputs), len(self.output_scale)))
        scaled = ((inputs - self.centre) / self.scale)[:, self.used]
        return np.asarray(np.mean([m.predict(scaled) for m in self.members], axis=0) * self.output_scale)


def fit_network(inputs: Floats, outputs: Floats, options: NetworkOptions) -> Network:
    """Fit an ensemble to examples in the order of time.

    Args:
        inputs: [N, D], N at least 4.
        outputs: [N, K], in any units: each is scaled by its root mean square.
        options: how.

    Raises:
        SettingsError: scikit-learn is missing.
    """
    spread = inputs.std(axis=0)
    used = spread > 1e-9 * np.maximum(np.abs(inputs).max(axis=0), 1e-9)
    centre, scale = inputs.mean(axis=0), np.where(used, spread, 1.0)
    size = np.maximum(np.sqrt(np.square(outputs).mean(axis=0)), 1e-12)
    x, y = ((inputs - centre) / scale)[:, used], outputs / size
    decay, errors = _chosen(x, y, options) if used.any() else (None, y[_cut(len(y)) :])
    members = (
        () if decay is None else tuple(_fitted(x, y, (decay, k), options) for k in range(options.members))
    )
    return Network(decay, members, errors * size, used, centre, scale, size)


def _chosen(x: Floats, y: Floats, options: NetworkOptions) -> tuple[float | None, Floats]:
    """The weight decay that predicts the last quarter best from the rest, and its errors there."""
    cut = _cut(len(x))
    best: tuple[float | None, Floats] = (None, y[cut:])
    least = np.abs(y[cut:]).mean() * (1.0 - options.least_gain) if options.may_abstain else np.inf
    for decay in options.weight_decays:
        errors = y[cut:] - _fitted(x[:cut], y[:cut], (decay, 0), options).predict(x[cut:])
        if np.abs(errors).mean() < least:
            least, best = np.abs(errors).mean(), (decay, errors)
    return best


def _cut(size: int) -> int:
    """Where the last quarter begins."""
    return size - max(size // 4, 1)


def _fitted(x: Floats, y: Floats, decay_and_seed: tuple[float, int], options: NetworkOptions) -> Any:
    decay, seed = decay_and_seed
    network = regressor_class()(
        hidden_layer_sizes=options.hidden,
        activation="tanh",
        solver="lbfgs",
        alpha=decay,
        max_iter=options.iterations,
        random_state=seed,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that L-BFGS stops at its last iteration is early stopping here
        return network.fit(x, y)


def regressor_class() -> Any:
    """Return scikit-learn's multi-layer perceptron.

    Raises:
        SettingsError: scikit-learn is missing.
    """
    try:
        from sklearn.neural_network import MLPRegressor
    except ImportError as problem:
        raise SettingsError(
            "neural networks need scikit-learn", advice="pip install 'scikit-learn>=1.4'"
        ) from problem
    return MLPRegressor

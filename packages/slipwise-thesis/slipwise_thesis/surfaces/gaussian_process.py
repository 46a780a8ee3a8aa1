# SPDX-License-Identifier: Apache-2.0
"""The slip surface by Gaussian process regression with scikit-learn (thesis 5.9, 5.10, Table 5.1)."""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.errors import SettingsError
from slipwise.extras import to_install
from slipwise_thesis.surfaces.examples import SlipExamples
from slipwise_thesis.surfaces.surface import SurfacePrediction, drive_arrays, not_fitted

Floats = NDArray[np.float64]

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class GaussianProcessOptions:
    """The kernel and how many examples it takes."""

    kernel: Literal["rbf", "matern"] = (
        "matern"  # anisotropic; matern: once mean-square differentiable (nu 3/2)
    )
    largest: int = 2000  # more examples are refused, or thinned to this many
    thin: bool = False  # thin instead of refusing
    shaped_by: int = 300  # kernel and noise are learned from so many examples spread over the drives
    learn_kernel: bool = True  # else the kernel of the last fit is kept


class GaussianProcessSurface:
    """One Gaussian process per channel; its mean returns to no slip far from the examples.

    Needs scikit-learn: the extra `gp`.
    """

    def __init__(self, *, options: GaussianProcessOptions = GaussianProcessOptions()) -> None:
        self.options = options
        self._examples: SlipExamples | None = None
        self._notes: tuple[str, ...] = ()
        self._scale = np.ones(2)  # of V and omega
        self._size = np.ones(3)  # of the slip rates
        self._nominal_std = np.zeros(3)
        self._kernels: list[Any] = []
        self._processes: list[Any] = []

    @property
    def notes(self) -> tuple[str, ...]:
        """Which examples were used where not all were."""
        return self._notes

    @property
    def kernels(self) -> tuple[str, ...]:
        """The learned kernel of each channel, over V and omega in units of their root mean squares."""
        return tuple(str(kernel) for kernel in self._kernels)

    def fit(self, examples: SlipExamples) -> None:
        """Learn from these examples alone, O(N^3).

        Raises:
            SettingsError: there are more examples than `largest`, or scikit-learn is missing.
        """
        used = self._admitted(examples)
        if self.options.learn_kernel or not self._kernels:
            drive = np.column_stack((used.v, used.omega))
            self._scale = _root_mean_square(drive)
            self._size = _root_mean_square(used.slip)
            shaping = used[spread_out(drive / self._scale, self.options.shaped_by)]
            self._kernels = [None, None, None]
            self._learn(shaping, optimise=True)
            self._kernels = [process.kernel_ for process in self._processes]
        self._learn(used, optimise=False)
        self._examples = used

    def update(self, example: SlipExamples) -> None:
        """Learn from more examples with the kernel kept: the whole matrix is factored again, O(N^3)."""
        if self._examples is None:
            self.fit(example)
            return
        used = self._admitted(self._examples.joined(example))
        self._learn(used, optimise=False)
        self._examples = used

    def predict(self, v: ArrayLike, omega: ArrayLike) -> SurfacePrediction:
        """Predict at speeds [M] m/s and yaw rates [M] rad/s.

        Where examples have standard deviations, that of their median is part of the prediction's.
        """
        if self._examples is None:
            raise not_fitted()
        speeds, yaw_rates = drive_arrays(v, omega)
        inputs = np.column_stack((speeds, yaw_rates)) / self._scale
        pairs = [process.predict(inputs, return_std=True) for process in self._processes]
        mean = np.column_stack([pair[0] for pair in pairs]) * self._size
        std = np.column_stack([pair[1] for pair in pairs]) * self._size
        return SurfacePrediction(mean, np.hypot(std, self._nominal_std), np.full(3, np.inf))

    def mean_covariance(self, v: ArrayLike, omega: ArrayLike) -> list[Floats]:
        """Joint covariance of the mean surface, without noise, per channel [M, M]."""
        if self._examples is None:
            raise not_fitted()
        speeds, yaw_rates = drive_arrays(v, omega)
        inputs = np.column_stack((speeds, yaw_rates)) / self._scale
        joint = []
        for process, size in zip(self._processes, self._size, strict=True):
            _, covariance = process.predict(inputs, return_cov=True)
            noise = float(process.kernel_.k2.noise_level)
            joint.append((covariance - noise * np.eye(len(inputs))) * size**2)
        return joint

    @property
    def noise_std(self) -> Floats:
        """Learned noise of one segment's slip rates (m/s, m/s, rad/s), [3]."""
        learned = np.sqrt([float(process.kernel_.k2.noise_level) for process in self._processes])
        return np.hypot(learned * self._size, self._nominal_std)

    @property
    def range(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest speed [m/s] and yaw rate [rad/s] of the examples."""
        if self._examples is None:
            raise not_fitted()
        v, omega = self._examples.v, self._examples.omega
        return (float(v.min()), float(v.max())), (float(omega.min()), float(omega.max()))

    def _admitted(self, examples: SlipExamples) -> SlipExamples:
        """Return the examples, or those of them that are used."""
        count, largest = len(examples), self.options.largest
        self._notes = ()
        if count <= largest:
            return examples
        if not self.options.thin:
            raise SettingsError(
                f"{count} examples are too many for a Gaussian process: {24e-9 * count**2:.1f} GB",
                advice=f"use the bayesian surface, or thin=True to use {largest} of them",
            )
        drive = np.column_stack((examples.v, examples.omega))
        note = f"the Gaussian process uses {largest} of {count} examples, spread over speeds and yaw rates"
        _log.warning("%s", note)
        self._notes = (note,)
        return examples[spread_out(drive / _root_mean_square(drive), largest)]

    def _learn(self, examples: SlipExamples, *, optimise: bool) -> None:
        regressor = _regressor_class()
        inputs = np.column_stack((examples.v, examples.omega)) / self._scale
        self._nominal_std = np.zeros(3) if examples.std is None else np.median(examples.std, axis=0)
        self._processes = []
        for channel in range(3):
            known = 0.0 if examples.std is None else np.square(examples.std[:, channel] / self._size[channel])
            process = regressor(
                kernel=self._kernels[channel] or _kernel(self.options.kernel),
                alpha=known + 1e-10,  # rounding of duplicates
                optimizer="fmin_l_bfgs_b" if optimise else None,
            )
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", _convergence_warning())  # of length scales that do not matter
                process.fit(inputs, examples.slip[:, channel] / self._size[channel])
            self._processes.append(process)


def spread_out(points: Floats, count: int) -> NDArray[np.int64]:
    """Places of `count` points that lie far apart, each the farthest from those before; ties in order.

    Where points coincide, the rest is taken at even steps through them. The result is in ascending order.
    """
    if count >= len(points):
        return np.arange(len(points), dtype=np.int64)
    first = int(np.argmin(np.sum(np.square(points - points.mean(axis=0)), axis=1)))
    chosen = [first]
    distance = np.sum(np.square(points - points[first]), axis=1)
    while len(chosen) < count and distance.max() > 0.0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.sum(np.square(points - points[chosen[-1]]), axis=1))
    left = np.setdiff1d(np.arange(len(points)), chosen)
    steps = np.linspace(0, len(left) - 1, count - len(chosen)).round().astype(np.int64)
    return np.sort(np.concatenate((np.array(chosen, dtype=np.int64), left[steps])))


def _root_mean_square(rows: Floats) -> Floats:
    size = np.sqrt(np.mean(np.square(rows), axis=0))
    return np.asarray(np.where(size > 0.0, size, 1.0), dtype=np.float64)


def _kernel(name: str) -> Any:
    """Signal times an anisotropic shape, plus learned noise; over scaled inputs and outputs."""
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Matern, WhiteKernel

    lengths = {"length_scale": [1.0, 1.0], "length_scale_bounds": (5e-2, 1e2)}
    shape = RBF(**lengths) if name == "rbf" else Matern(nu=1.5, **lengths)
    return ConstantKernel(1.0, (1e-4, 1e4)) * shape + WhiteKernel(0.1, (1e-8, 1e1))


def require_scikit_learn() -> None:
    """Raise SettingsError where scikit-learn is missing."""
    _regressor_class()


def _regressor_class() -> Any:
    try:
        from sklearn.gaussian_process import GaussianProcessRegressor
    except ImportError as problem:
        raise SettingsError("the Gaussian process needs scikit-learn", advice=to_install("gp")) from problem
    return GaussianProcessRegressor


def _convergence_warning() -> type[Warning]:
    from sklearn.exceptions import ConvergenceWarning

    warning: type[Warning] = ConvergenceWarning
    return warning

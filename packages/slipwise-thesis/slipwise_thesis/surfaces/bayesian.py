# SPDX-License-Identifier: Apache-2.0
"""The slip surface by Bayesian linear regression, learned on-line (thesis 5.11-5.19)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.surfaces.basis_slip import (
    BasisSlip,
    block_covariance,
    channel_designs,
    channel_slices,
    not_identifiable,
)
from slipwise_thesis.surfaces.examples import SlipExamples
from slipwise_thesis.surfaces.surface import SurfacePrediction, drive_arrays, not_fitted

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BayesianOptions:
    """The posterior before any example, and how many are remembered."""

    reference: tuple[float, float] | None = None  # usual V [m/s], omega [rad/s]; None: from the fit
    slip_fraction: float = 0.3  # standard deviation of a term's slip as a fraction of the motion
    noise_fraction: float = 0.01  # noise of a slip rate before any example, as a fraction of the motion
    noise_examples: float = 3.0  # how many examples that is worth; inf: the noise is known (thesis)
    window: int | None = None  # the latest examples to remember; None: all


class BayesianSurface:
    """One regression per channel over the terms of a basis; adding an example costs O(d^2).

    Standard deviations of examples weigh them against the median of the first fit.
    """

    def __init__(self, basis: _core.Basis, *, options: BayesianOptions = BayesianOptions()) -> None:
        self.basis = basis
        self.options = options
        self._reference = options.reference
        self._nominal_std: Floats | None = None  # [3]
        self._notes: tuple[str, ...] = ()
        self._plain: list[_thesis.BayesianRegression] = []
        self._sliding: list[_thesis.SlidingRegression] = []
        if self._reference is not None:
            self._start(self._reference)

    @property
    def notes(self) -> tuple[str, ...]:
        """Directions in which the prior alone speaks, as of the last fit."""
        return self._notes

    def fit(self, examples: SlipExamples) -> None:
        """Learn from these examples alone."""
        self._reference = self.options.reference or examples.reference
        self._nominal_std = None
        self._start(self._reference)
        self.update(examples)
        self._notes = tuple(f"{said} but by the prior" for said in not_identifiable(self.basis, examples))

    def update(self, example: SlipExamples) -> None:
        """Learn from more examples; the oldest are forgotten where there is a window.

        Raises:
            SettingsError: there was no fit and the options name no reference speeds.
        """
        for learner, rows in zip(self._learners(), self._rows(example), strict=True):
            for row in rows:
                learner.add(row)

    def remove(self, example: SlipExamples) -> None:
        """Forget examples that were learned before.

        Raises:
            SettingsError: they were not learned, or the surface has a window that forgets by itself.
        """
        if self.options.window is not None:
            raise SettingsError(
                "a surface with a window forgets by itself", advice="use window=None to remove"
            )
        self._learners()
        rest = self._copies()
        try:
            for regression, rows in zip(rest, self._rows(example), strict=True):
                for row in rows:
                    regression.remove(row)
        except ValueError as problem:
            raise SettingsError(str(problem), advice="remove what update or fit was given") from problem
        self._plain = rest

    def merged(self, other: BayesianSurface) -> BayesianSurface:
        """Return what both would know together; the prior counts once.

        Raises:
            SettingsError: bases, priors or usual standard deviations differ, or there is a window.
        """
        usual = (self._nominal_std, other._nominal_std)
        same_std = usual[0] is usual[1] or (
            usual[0] is not None and usual[1] is not None and np.array_equal(usual[0], usual[1])
        )
        if self.options.window is not None or other.options.window is not None or not same_std:
            raise SettingsError(
                "surfaces with a window or of differently known examples cannot be merged",
                advice="fit one surface to all examples",
            )
        whole = BayesianSurface(self.basis, options=self.options)
        whole._reference, whole._nominal_std = self._reference, self._nominal_std
        try:
            pairs = zip(self._regressions(), other._regressions(), strict=True)
            whole._plain = [mine.merged(theirs) for mine, theirs in pairs]
        except ValueError as problem:
            raise SettingsError(str(problem), advice="give both the same reference speeds") from problem
        return whole

    def predict(self, v: ArrayLike, omega: ArrayLike) -> SurfacePrediction:
        """Predict at speeds [M] m/s and yaw rates [M] rad/s (5.17, 5.19)."""
        regressions = self._regressions()
        speeds, yaw_rates = drive_arrays(v, omega)
        designs = channel_designs(self.basis, speeds, yaw_rates)
        pairs = [r.predict_rows(design) for r, design in zip(regressions, designs, strict=True)]
        mean = np.column_stack([pair[0] for pair in pairs])
        std = np.column_stack([pair[1] for pair in pairs])
        return SurfacePrediction(mean, std, np.array([r.freedom for r in regressions]))

    def basis_slip(self) -> BasisSlip:
        """Return the surface as parameters, exactly."""
        regressions = self._regressions()
        return BasisSlip(
            self.basis,
            np.concatenate([regression.mean for regression in regressions]),
            block_covariance(self.basis, [regression.covariance for regression in regressions]),
            self._prior_std(),
            np.sqrt([regression.noise_variance for regression in regressions]),
        )

    def _prior_std(self) -> Floats:
        if self._reference is None:
            raise not_fitted()
        v, omega = self._reference
        std = _core.slip_prior_std(self.basis, v, omega, self.options.slip_fraction)
        return np.asarray(std, dtype=np.float64)

    def _start(self, reference: tuple[float, float]) -> None:
        options, std = self.options, self._prior_std()
        if not (options.noise_fraction > 0.0 and options.noise_examples > 0.0 and (options.window or 1) > 0):
            raise SettingsError("noise fraction, noise examples and window must be positive")
        noise = [options.noise_fraction * reference[place] for place in (0, 0, 1)]
        self._plain = [
            _thesis.BayesianRegression(std[part], size, options.noise_examples)
            for part, size in zip(channel_slices(self.basis), noise, strict=True)
        ]
        if options.window is not None:
            self._sliding = [_thesis.SlidingRegression(empty, options.window) for empty in self._plain]

    def _learners(self) -> Sequence[_thesis.BayesianRegression | _thesis.SlidingRegression]:
        if not self._plain:
            raise not_fitted()
        if self.options.window is None:
            return self._plain
        return self._sliding

    def _regressions(self) -> list[_thesis.BayesianRegression]:
        self._learners()
        return self._plain if self.options.window is None else [s.regression for s in self._sliding]

    def _copies(self) -> list[_thesis.BayesianRegression]:
        """Copies, by merging with a surface that knows nothing."""
        empty = BayesianSurface(self.basis, options=self.options)
        if self._reference is None:
            raise not_fitted()
        empty._reference = self._reference
        empty._start(self._reference)
        return [mine.merged(nothing) for mine, nothing in zip(self._plain, empty._plain, strict=True)]

    def _rows(self, examples: SlipExamples) -> list[list[_thesis.RegressionExample]]:
        """Examples of each channel for the core."""
        if examples.std is not None and self._nominal_std is None:
            self._nominal_std = np.median(examples.std, axis=0)
        relative = np.ones((len(examples), 3))
        if examples.std is not None and self._nominal_std is not None:
            relative = examples.std / self._nominal_std
        designs = channel_designs(self.basis, examples.v, examples.omega)
        return [
            [
                _thesis.RegressionExample(features, float(output), float(std))
                for features, output, std in zip(
                    design, examples.slip[:, channel], relative[:, channel], strict=True
                )
            ]
            for channel, design in enumerate(designs)
        ]

# SPDX-License-Identifier: Apache-2.0
"""The least-squares slip surface with its surface of standard deviations (thesis 5.1-5.8)."""

from __future__ import annotations

from typing import Literal

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
    scaled_svd,
)
from slipwise_thesis.surfaces.examples import CHANNELS, SlipExamples
from slipwise_thesis.surfaces.surface import SurfacePrediction, drive_arrays, not_fitted

Floats = NDArray[np.float64]
Spread = Literal["log-variance", "thesis"]


class LeastSquaresSurface:
    """Least squares over the terms of a basis.

    Args:
        basis: the terms per channel; `thesis-15` are those of (5.1).
        spread: "log-variance", or "thesis": (5.6-5.8) as written, which reads 20 % low, leaves out what is
            not known of the mean, and may be negative; for comparison.
    """

    def __init__(self, basis: _core.Basis, *, spread: Spread = "log-variance") -> None:
        self.basis = basis
        self._spread = spread
        self._examples: SlipExamples | None = None
        self._notes: tuple[str, ...] = ()
        self._fits: list[_thesis.LeastSquaresFit] = []

    @property
    def notes(self) -> tuple[str, ...]:
        """Directions that the examples do not determine."""
        return self._notes

    def fit(self, examples: SlipExamples) -> None:
        """Learn from these examples alone; standard deviations weigh them (5.5).

        Raises:
            SettingsError: there are no more examples than terms they determine, so that no noise is seen.
        """
        fits = []
        for channel, design in enumerate(channel_designs(self.basis, examples.v, examples.omega)):
            fit = _thesis.fit_least_squares(
                design, np.ascontiguousarray(examples.slip[:, channel]), relative_std(examples)[channel]
            )
            if len(examples) <= fit.rank:
                raise SettingsError(
                    f"{len(examples)} examples determine {fit.rank} terms and leave none to judge noise by",
                    where=CHANNELS[channel],
                    advice="give more examples, or use the bayesian surface",
                )
            fits.append(fit)
        self._fits, self._examples = fits, examples
        self._notes = tuple(not_identifiable(self.basis, examples))

    def update(self, example: SlipExamples) -> None:
        """Learn from more examples by fitting all again, O(N d^2)."""
        self.fit(example if self._examples is None else self._examples.joined(example))

    def predict(self, v: ArrayLike, omega: ArrayLike) -> SurfacePrediction:
        """Predict at speeds [M] m/s and yaw rates [M] rad/s.

        The standard deviation is infinite where the examples do not determine the mean.
        """
        if self._examples is None:
            raise not_fitted()
        speeds, yaw_rates = drive_arrays(v, omega)
        mean, std = np.empty((len(speeds), 3)), np.empty((len(speeds), 3))
        designs = channel_designs(self.basis, speeds, yaw_rates)
        for channel, (fit, design) in enumerate(zip(self._fits, designs, strict=True)):
            mean[:, channel] = design @ fit.coefficients
            std[:, channel] = self._std(channel, design, np.column_stack((speeds, yaw_rates)))
        return SurfacePrediction(mean, std, np.full(3, np.inf))

    def _std(self, channel: int, design: Floats, drive: Floats) -> Floats:
        examples, fit = self._examples, self._fits[channel]
        if examples is None:
            raise not_fitted()
        if self._spread == "thesis":
            seen = channel_designs(self.basis, examples.v, examples.omega)[channel]
            return np.asarray(design @ _thesis.thesis_std_coefficients(seen, fit), dtype=np.float64)
        seen_drive = np.asfortranarray(np.column_stack((examples.v, examples.omega)))
        spread = _thesis.fit_log_variance(seen_drive, fit)
        noise = np.array([spread.std(v, omega) for v, omega in drive.tolist()])
        return np.asarray(np.sqrt(np.square(noise) + fit.mean_variances(design)), dtype=np.float64)

    def basis_slip(self, *, prior_std: Floats | None = None) -> BasisSlip:
        """Return the surface as parameters, exactly.

        Args:
            prior_std: of the parameters, [p]; what the examples do not determine keeps it, with mean zero.

        Raises:
            SettingsError: nothing was learned, or a direction is not determined and has no prior.
        """
        if self._examples is None:
            raise not_fitted()
        if self._notes and prior_std is None:
            raise SettingsError(
                "the examples do not determine the surface",
                where="; ".join(self._notes),
                advice="drive at more speeds and curvatures, use fewer terms, or the bayesian surface",
            )
        noise = [np.sqrt(np.sum(np.square(f.residual)) / (len(f.residual) - f.rank)) for f in self._fits]
        blocks = [np.array(fit.covariance) for fit in self._fits]
        alpha = [np.array(fit.coefficients) for fit in self._fits]
        if self._notes and prior_std is not None:
            designs = channel_designs(self.basis, self._examples.v, self._examples.omega)
            for channel, part in enumerate(channel_slices(self.basis)):
                design = designs[channel]
                inverse, rest = scaled_svd(design, prior_std[part])
                alpha[channel] = inverse @ (design @ alpha[channel])
                seen = inverse @ design
                blocks[channel] = seen @ blocks[channel] @ seen.T + rest
        return BasisSlip(
            self.basis,
            np.concatenate(alpha),
            block_covariance(self.basis, blocks),
            np.full(self.basis.size, np.inf) if prior_std is None else prior_std,
            np.array(noise),
        )


def relative_std(examples: SlipExamples) -> Floats:
    """Standard deviations over their median per channel, [3, N]; ones where they are not known."""
    if examples.std is None:
        return np.ones((3, len(examples)))
    return np.ascontiguousarray((examples.std / np.median(examples.std, axis=0)).T)

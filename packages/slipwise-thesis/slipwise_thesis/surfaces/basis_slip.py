# SPDX-License-Identifier: Apache-2.0
"""A slip surface as the parameters of a slip basis, which a motion model can use."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise_thesis import _thesis
from slipwise_thesis.surfaces.examples import CHANNELS, SlipExamples

Floats = NDArray[np.float64]

_NEGLIGIBLE = 1e-9  # a singular value smaller than this part of the largest one counts as zero


@dataclass(frozen=True, eq=False)
class BasisSlip:
    """Parameters of a basis with their covariance, and the noise about them."""

    basis: _core.Basis
    alpha: Floats  # [p]
    covariance: Floats  # [p, p]
    prior_std: Floats  # [p] before the examples; infinite where there was no prior
    noise_std: Floats  # [3] of one segment's slip rates (m/s, m/s, rad/s), mean over the examples
    projection_rms: Floats = field(default_factory=lambda: np.zeros(3))  # what the basis misses
    projection_largest: Floats = field(default_factory=lambda: np.zeros(3))  # at most


def channel_slices(basis: _core.Basis) -> tuple[slice, slice, slice]:
    """Where the parameters of lon, lat and ang stand."""
    lon, lat = len(basis.lon), len(basis.lon) + len(basis.lat)
    return slice(0, lon), slice(lon, lat), slice(lat, basis.size)


def channel_designs(basis: _core.Basis, v: Floats, omega: Floats) -> list[Floats]:
    """Features of each channel's terms, [N, terms of the channel]; kappa is finite at V = 0."""
    rows = _thesis.feature_rows(basis, v, omega)
    return [np.asfortranarray(rows[:, part]) for part in channel_slices(basis)]


def channel_terms(basis: _core.Basis) -> tuple[list[str], list[str], list[str]]:
    """Texts of the terms of lon, lat and ang."""
    return basis.lon, basis.lat, basis.ang


def block_covariance(basis: _core.Basis, blocks: list[Floats]) -> Floats:
    """Covariance of all parameters from those of the channels, which are learned apart."""
    covariance = np.zeros((basis.size, basis.size))
    for part, block in zip(channel_slices(basis), blocks, strict=True):
        covariance[part, part] = block
    return covariance


def scaled_svd(design: Floats, prior_std: Floats) -> tuple[Floats, Floats]:
    """Split what the rows of a design [N, d] determine from what they do not, in units of the prior.

    Returns:
        The pseudo-inverse [d, N], and the covariance [d, d] that a prior of `prior_std` [d] leaves the rest.
    """
    rows, terms = design.shape
    if terms == 0:
        return np.zeros((0, rows)), np.zeros((0, 0))
    scaled = np.vstack((design * prior_std, np.zeros((max(0, terms - rows), terms))))
    u, size, vt = np.linalg.svd(scaled, full_matrices=False)
    rank = int(np.sum(size > _NEGLIGIBLE * size.max()))
    known, rest = prior_std[:, None] * vt[:rank].T, prior_std[:, None] * vt[rank:].T
    return known / size[:rank] @ u[:rows, :rank].T, rest @ rest.T


def not_identifiable(basis: _core.Basis, examples: SlipExamples) -> list[str]:
    """What the drives of the examples do not determine, such as 'lon: V and V^2 cannot be distinguished'."""
    said = []
    for name, design, terms in zip(
        CHANNELS, channel_designs(basis, examples.v, examples.omega), channel_terms(basis), strict=True
    ):
        if terms:
            ones = np.ones(len(examples))
            fit = _thesis.fit_least_squares(design, ones, ones)
            said += [f"{name}: {text}" for text in _thesis.undetermined_directions(fit, terms)]
    return said

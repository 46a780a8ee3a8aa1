# SPDX-License-Identifier: Apache-2.0
"""Optimised slip rates against speed and curvature with 1-sigma bars, as plain data (figures 4.9, 4.10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise.errors import LogError
from slipwise_thesis import _thesis
from slipwise_thesis.steady.groups import SteadyGroup
from slipwise_thesis.steady.noise import LEAST_SEGMENTS, NoiseRules, fit_group_noise
from slipwise_thesis.steady.slip_fit import SlipFitRules, fit_slip

PLAIN = SlipFitRules()  # (4.1), three channels, no weights
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class SlipRow:
    """Slip rates of one group; channels are (lon [m/s], lat [m/s], ang [rad/s])."""

    v: float  # m/s
    curvature: float | None  # 1/m; None: a turn in place
    omega: float  # rad/s
    segments: int
    slip: Triple
    sigma: Triple  # of the fitted mean
    bar: Triple | None  # of one segment's mean slip, sqrt(q / length): the bars of 4.9; None: it is unknown


def slip_table(groups: Sequence[SteadyGroup], rules: SlipFitRules = PLAIN) -> tuple[SlipRow, ...]:
    """Fit every group; groups of one segment are left out unless `rules.noise` is given.

    Raises:
        LogError: a group cannot be fitted.
    """
    needed = 2 if rules.noise is None else 1
    return tuple(_row(group, rules) for group in groups if len(group) >= needed)


def _row(group: SteadyGroup, rules: SlipFitRules) -> SlipRow:
    fit = fit_slip(group, rules)
    variance = np.diag(fit.covariance) * group.overlap
    bar = None
    noise = rules.noise or _noise_of(group)
    if noise is not None:
        length = min(float(path.times[-1]) for path in group.paths)
        bar = _triple(np.sqrt(np.array(noise.psd) / length))
    sigma = _triple(np.sqrt(variance))
    return SlipRow(group.v, group.curvature, group.omega, len(group), _triple(np.array(fit.slip)), sigma, bar)


def _noise_of(group: SteadyGroup) -> _thesis.SteadyNoise | None:
    """Return the group's own noise, None where too few or duplicate segments do not tell it."""
    if len(group) < LEAST_SEGMENTS:
        return None
    try:
        return fit_group_noise([group], NoiseRules()).noise
    except LogError:
        return None


def _triple(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Triple:
    lon, lat, ang = (float(value) for value in values)
    return lon, lat, ang

# SPDX-License-Identifier: Apache-2.0
"""Slip noise and start uncertainty of groups from their scatter (thesis 4.3)."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError, SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady.groups import SteadyGroup
from slipwise_thesis.steady.slip_fit import fit_slip, slipped_twist

Floats = NDArray[np.float64]

_LOGGER = logging.getLogger(__name__)
LEAST_SEGMENTS = 3  # one residual's outer product has rank 1


@dataclass(frozen=True)
class NoiseRules:
    """How noise is fitted."""

    times: int = 6  # at which the scatter is looked at, evenly over the segments' common length
    objective: _thesis.NoiseObjective = _thesis.NoiseObjective.Fisher  # or Thesis: (4.13)
    centre: _thesis.ScatterCentre = _thesis.ScatterCentre.Mean  # or Curve: around the best fit
    pose_std: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m, m, rad of a measured pose, where it is known


@dataclass(frozen=True, eq=False)
class GroupNoise:
    """What the scatter says."""

    noise: _thesis.SteadyNoise  # psd [m^2/s, m^2/s, rad^2/s], start [m^2, m^2, rad^2]
    covariance: Floats  # [6, 6] of (psd, start), grown by the overlap of the segments
    status: _core.Status
    notes: tuple[str, ...]  # what to know about the data: short rank, noises held at zero, groups left out


def scatter_group(group: SteadyGroup, times: int) -> _thesis.NoiseGroup:
    """Return the group's residuals around its best-fit curve at the poses nearest to common times.

    Raises:
        LogError: there are fewer than three segments.
        SettingsError: there are fewer than two times.
    """
    if times < 2:
        raise SettingsError(f"{times} times", where="times", advice="slip noise and P0 need at least two")
    if len(group) < LEAST_SEGMENTS:
        raise LogError(
            f"a scatter needs at least {LEAST_SEGMENTS} segments, got {len(group)}",
            where=group.name,
            advice="drive the same command longer, allow wider groups, or shorter segments",
        )
    fit = fit_slip(group)
    last = min(float(path.times[-1]) for path in group.paths)
    common = last * np.arange(1, times + 1) / times
    # The nearest poses: interpolated ones would have less pose noise than was measured.
    residuals = [
        np.array(residual)[:, _nearest(path.times[1:], common)]
        for path, residual in zip(group.paths, fit.residuals, strict=True)
    ]
    return _thesis.NoiseGroup(slipped_twist(group, np.array(fit.slip)), common.tolist(), residuals)


def _nearest(times: Floats, wanted: Floats) -> NDArray[np.int64]:
    """Indices of the times [N] nearest to those wanted [K]."""
    return np.asarray(np.argmin(np.abs(times[:, None] - wanted), axis=0), dtype=np.int64)


def fit_group_noise(groups: Sequence[SteadyGroup], rules: NoiseRules = NoiseRules()) -> GroupNoise:
    """Fit one slip noise and P0 to all groups together; groups of fewer than three segments are left out.

    Raises:
        LogError: no group has three segments, or the segments do not scatter.
        SettingsError: there are fewer than two times, or a standard deviation is negative or not finite.
    """
    if not all(np.isfinite(std) and std >= 0 for std in rules.pose_std):
        raise SettingsError(f"pose_std is {rules.pose_std}", where="pose_std", advice="give zero or more")
    usable = [group for group in groups if len(group) >= LEAST_SEGMENTS] or list(groups[:1])
    if not usable:
        raise LogError("there are no groups", advice="look for held commands, or allow shorter segments")
    settings = _thesis.NoiseFitSettings()
    settings.objective, settings.centre = rules.objective, rules.centre
    settings.pose = np.array(rules.pose_std) ** 2
    try:
        fit = _thesis.fit_noise([scatter_group(group, rules.times) for group in usable], settings)
    except ValueError as error:
        raise LogError(str(error), where=usable[0].name if len(usable) == 1 else "all groups") from error
    notes = _notes(fit, len(groups) - len(usable))
    for note in notes:
        _LOGGER.info("%s", note)
    overlap = max(group.overlap for group in usable)
    return GroupNoise(fit.noise, np.array(fit.covariance) * overlap, fit.status, notes)


def _notes(fit: _thesis.NoiseFit, left_out: int) -> tuple[str, ...]:
    notes = []
    if left_out:
        notes.append(f"{left_out} groups with fewer than {LEAST_SEGMENTS} segments were left out")
    if not fit.scatter_definite:
        notes.append("a scatter matrix is not positive definite: too few segments, or duplicates among them")
    names = ("lon", "lat", "ang")
    for kind, values in (("slip noise", fit.noise.psd), ("P0", fit.noise.start)):
        zero = [name for name, value in zip(names, np.array(values).tolist(), strict=True) if value <= 0.0]
        if zero:
            notes.append(f"{kind} held at zero: {', '.join(zero)}")
    return tuple(notes)

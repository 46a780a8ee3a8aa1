# SPDX-License-Identifier: Apache-2.0
"""Slip rates of a group, beside translation alone and a second-order polynomial (thesis 4.2, figure 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError, SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady.groups import SteadyGroup

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SlipFitRules:
    """How slip rates are fitted."""

    length: float = 1.0  # m, L of (4.1): a turn of 1 rad weighs like this distance
    angular: bool = True  # False: translation alone
    noise: _thesis.SteadyNoise | None = None  # weigh by the inverse of the covariance that this noise causes


@dataclass(frozen=True, eq=False)
class CurveResidual:
    """What one kind of curve leaves over, over all poses of all segments."""

    name: str  # "no slip", "translation", "three channels" or "polynomial"
    cost: float  # (4.1) with L^2
    rms_position: float  # m
    rms_heading: float  # rad
    path: Floats  # [K, 3] the curve at `FitComparison.times`


@dataclass(frozen=True, eq=False)
class FitComparison:
    """The argument of figure 4.2 in numbers."""

    times: Floats  # [K] s
    curves: tuple[CurveResidual, ...]
    slip: Floats  # [3] of the three channels
    translation: Floats  # [3] of translation alone; the last is 0
    to_polynomial: float  # m, rms distance of the three-channel path from the polynomial
    translation_to_polynomial: float  # m, the same for translation alone

    def curve(self, name: str) -> CurveResidual:
        """Return one curve by its name."""
        return next(curve for curve in self.curves if curve.name == name)


def fit_slip(group: SteadyGroup, rules: SlipFitRules = SlipFitRules()) -> _thesis.SlipRateFit:
    """Fit the slip rates of one group. For overlapping segments, multiply the covariance by `group.overlap`.

    Raises:
        LogError: the group has one segment and no noise is given, a segment is there twice, or has one pose.
        SettingsError: the noise is not finite.
    """
    if (
        rules.noise is not None
        and not np.isfinite([rules.noise.psd, rules.noise.start, rules.noise.pose]).all()
    ):
        raise SettingsError("a variance is not finite", where="noise", advice="give zero or more")
    settings = _thesis.SlipRateSettings()
    settings.length, settings.angular, settings.noise = rules.length, rules.angular, rules.noise
    try:
        return _thesis.fit_slip_rates(group.core(), settings)
    except ValueError as error:
        raise LogError(str(error), where=group.name) from error


def compare_fits(group: SteadyGroup, *, length: float = 1.0, points: int = 31) -> FitComparison:
    """Compare no slip, translation, three channels and a polynomial of second order per coordinate in time.

    The polynomial goes through the origin. It fits as well as three channels do, but says nothing of slip.

    Raises:
        LogError: as `fit_slip`.
        SettingsError: there are fewer than two points.
    """
    if points < 2:
        raise SettingsError(f"{points} points", where="points", advice="a curve needs at least two")
    translation = fit_slip(group, SlipFitRules(length=length, angular=False))
    full = fit_slip(group, SlipFitRules(length=length))
    times = np.linspace(0.0, min(float(path.times[-1]) for path in group.paths), points)
    curves = []
    for name, slip in (
        ("no slip", np.zeros(3)),
        ("translation", translation.slip),
        ("three channels", full.slip),
    ):
        left = np.concatenate([_thesis.steady_residuals(s, slip).T for s in group.core()])
        curves.append(_curve(name, left, slip_path(group, slip, times), length))
    coefficients = _polynomial(group)
    powers = np.column_stack((times, times**2))
    left = np.concatenate([_powers(path.times) @ -coefficients + path.poses[1:] for path in group.paths])
    curves.append(_curve("polynomial", left, powers @ coefficients, length))
    return FitComparison(
        times,
        tuple(curves),
        np.array(full.slip),
        np.array(translation.slip),
        _distance(curves[2].path, curves[3].path),
        _distance(curves[1].path, curves[3].path),
    )


def slip_path(group: SteadyGroup, slip: Floats, times: Floats) -> Floats:
    """Return where the group's command with constant slip rates [3] leads at `times` [K], [K, 3]."""
    return np.array(_thesis.steady_path(slipped_twist(group, slip), times))


def slipped_twist(group: SteadyGroup, slip: Floats) -> _core.BodyTwist:
    """Return the group's mean command plus slip rates [3]."""
    lon, lat, ang = (float(value) for value in slip)
    return _core.BodyTwist(group.v + lon, group.vy + lat, group.omega + ang)


def _powers(times: Floats) -> Floats:
    return np.column_stack((times[1:], times[1:] ** 2))


def _polynomial(group: SteadyGroup) -> Floats:
    """Coefficients [2, 3] of t and t^2 for x, y and yaw by least squares over all segments."""
    rows = np.concatenate([_powers(path.times) for path in group.paths])
    values = np.concatenate([path.poses[1:] for path in group.paths])
    return np.asarray(np.linalg.lstsq(rows, values, rcond=None)[0], dtype=np.float64)


def _curve(name: str, left: Floats, path: Floats, length: float) -> CurveResidual:
    square = np.mean(left**2, axis=0)
    cost = len(left) * float(square[0] + square[1] + length**2 * square[2])
    return CurveResidual(name, cost, float(np.sqrt(square[0] + square[1])), float(np.sqrt(square[2])), path)


def _distance(a: Floats, b: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum((a[:, :2] - b[:, :2]) ** 2, axis=1))))

# SPDX-License-Identifier: Apache-2.0
"""The thesis's own simulator: commands perturbed by slip surfaces and their variance (thesis 6.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs
from slipwise_sim.land_tamer import LandTamer
from slipwise_sim.truth import Truth

Floats = NDArray[np.float64]

_LEFT_OUT = 1e-9  # [s] of rounding between stamps that are meant to be the same


class SlipPrediction(Protocol):
    """Slip rates (m/s, m/s, rad/s) and their standard deviations, [N, 3] each."""

    @property
    def mean(self) -> Floats:
        """The mean of each."""
        ...

    @property
    def std(self) -> Floats:
        """The standard deviation of each."""
        ...


class SlipSurface(Protocol):
    """Slip rates over speed and yaw rate; the surfaces of slipwise-thesis are such."""

    def predict(self, v: Floats, omega: Floats) -> SlipPrediction:
        """Predict at speeds [N] m/s and yaw rates [N] rad/s."""
        ...


@dataclass(frozen=True, eq=False)
class Perturbation:
    """Slip rates that a fitted surface gives, and white noise about them; a robot that is to stand stands."""

    surface: SlipSurface
    segment: float = (
        3.0  # [s] length of the segments that it was learned from: the mean over it has its spread
    )
    spread: float = 1.0  # [1] of the surface's standard deviation; 0: the mean surfaces alone


def perturbed_truth(
    perturbation: Perturbation,
    vehicle: LandTamer,
    commands: Inputs,
    times: Floats,
    *,
    random: np.random.Generator,
) -> Truth:
    """Drive by the commands plus slip rates, from the world's origin, facing along x, without lag or delay.

    The noise has the density `(spread * std)^2 * segment`, so that its mean over a segment has the stated
    standard deviation. It is constant between two of the times.

    Args:
        perturbation: the surfaces.
        vehicle: turns commands into wheel rates, which do as they are commanded.
        commands: nothing is commanded before the first.
        times: of the true states [M] s, evenly from 0 on.
        random: gives the noise.

    Raises:
        SettingsError: the surface is not determined or has no positive spread somewhere along the drive.
    """
    _check(perturbation)
    knots = np.unique(np.concatenate((times, commands.t[(commands.t > 0.0) & (commands.t < times[-1])])))
    commanded = _held(commands, knots)
    mean, std = _slip(perturbation.surface, commanded)
    rate = (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 1.0
    drawn = random.standard_normal((len(times), 3))
    interval = np.searchsorted(times, knots + _LEFT_OUT, side="right") - 1
    size = perturbation.spread * math.sqrt(perturbation.segment * rate)
    twist = commanded + mean + size * std * drawn[interval]
    places = np.searchsorted(knots, times - _LEFT_OUT)
    poses = _integrated(knots, twist, times)
    wheels = vehicle.side_rates(commanded[places, 0], commanded[places, 2])
    x, y, yaw, vx, vy, omega, left, right = (
        np.ascontiguousarray(column) for column in np.hstack((poses, twist[places], wheels)).T
    )
    return Truth(times, x, y, yaw, vx, vy, omega, left, right)


def _held(commands: Inputs, knots: Floats) -> Floats:
    """The twists (V, 0, omega) held from each knot on, [N, 3]; zero before the first command."""
    at = np.searchsorted(commands.t, knots + _LEFT_OUT, side="right") - 1
    columns = commands.twists()
    return np.where((at >= 0)[:, None], columns[np.maximum(at, 0)], 0.0)


def _slip(surface: SlipSurface, commanded: Floats) -> tuple[Floats, Floats]:
    """Mean and standard deviation [N, 3] of the slip rates; no slip where the robot is commanded to stand."""
    distinct, place = np.unique(commanded, axis=0, return_inverse=True)
    moving = np.any(distinct != 0.0, axis=1)
    mean, std = np.zeros((len(distinct), 3)), np.zeros((len(distinct), 3))
    if moving.any():
        prediction = surface.predict(distinct[moving, 0], distinct[moving, 2])
        mean[moving], std[moving] = prediction.mean, prediction.std
    bad = ~(np.isfinite(mean) & np.isfinite(std) & (std >= 0.0)).all(axis=1)
    if bad.any():
        v, _, omega = distinct[bad][0].tolist()
        raise SettingsError(
            "the slip surface has no mean with a spread there",
            where=f"V = {v:.3g} m/s, omega = {omega:.3g} rad/s",
            advice="learn it from more speeds and curvatures, and not with the thesis's spread",
        )
    return mean[place.ravel()], std[place.ravel()]


def _integrated(knots: Floats, twist: Floats, times: Floats) -> Floats:
    """Poses [M, 3] at the times of twists [N, 3], each held from its knot on."""
    model = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    history = _core.InputHistory(knots, *(np.ascontiguousarray(column) for column in twist.T))
    segment = _core.Segment(float(times[0]), float(times[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(model, np.zeros(0), history, segment, _core.Integrator.Exact)
    return np.asarray(path.poses)[np.searchsorted(path.times, times - _LEFT_OUT)]


def _check(perturbation: Perturbation) -> None:
    if not (math.isfinite(perturbation.segment) and perturbation.segment > 0):
        raise SettingsError(
            f"segment is {perturbation.segment}", where="segment", advice="give a positive number of seconds"
        )
    if not (math.isfinite(perturbation.spread) and perturbation.spread >= 0):
        raise SettingsError(
            f"spread is {perturbation.spread}", where="spread", advice="give zero or a positive number"
        )

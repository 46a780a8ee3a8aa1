# SPDX-License-Identifier: Apache-2.0
"""Drawing new path segments from learned slip and noise (thesis figures 4.4 to 4.6)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis import _thesis

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class DrawRules:
    """What is drawn."""

    count: int = 100  # segments
    length: float = 3.0  # s
    period: float = 0.05  # s between poses; the noise is constant for as long
    start: bool = True  # with P0; alone: figure 4.5
    process: bool = True  # with slip noise; alone: figure 4.6


@dataclass(frozen=True, eq=False)
class DrawnPaths:
    """Drawn segments."""

    times: Floats  # [K] s, the first is 0
    poses: Floats  # [count, K, 3] x, y [m], yaw [rad]


def draw_paths(
    twist: _core.BodyTwist, noise: _thesis.SteadyNoise, *, seed: int, rules: DrawRules = DrawRules()
) -> DrawnPaths:
    """Draw path segments around a steady twist (command and slip). The same seed gives the same segments.

    Raises:
        SettingsError: count, length or period makes no sense, or a variance is negative.
    """
    _check(noise, rules)
    steps = max(1, round(rules.length / rules.period))
    times = np.linspace(0.0, rules.length, steps + 1)
    rng = np.random.Generator(np.random.PCG64(seed))
    starts = rng.standard_normal((rules.count, 3)) * np.sqrt(noise.start) * rules.start
    rates = rng.standard_normal((rules.count, steps, 3)) * np.sqrt(noise.psd * steps / rules.length)
    rates = rates * rules.process + np.array([twist.v, twist.vy, twist.omega])
    poses = [_integrate(start, rate, times) for start, rate in zip(starts, rates, strict=True)]
    return DrawnPaths(times, np.array(poses))


def _integrate(start: Floats, rates: Floats, times: Floats) -> Floats:
    """Return the poses [K, 3] of twists [K - 1, 3], each held for one step, from a start [3]."""
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    columns = (np.ascontiguousarray(column) for column in rates.T)
    history = _core.InputHistory(times[:-1], *columns)
    segment = _core.Segment(0.0, float(times[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(model, np.zeros(2), history, segment, _core.Integrator.Exact)
    origin = _core.Pose2(*start.tolist())
    knots = np.searchsorted(path.times, times - 1e-9)
    moved = [_core.compose(origin, _core.Pose2(*pose)).vector() for pose in path.poses[knots].tolist()]
    return np.array(moved)


def _check(noise: _thesis.SteadyNoise, rules: DrawRules) -> None:
    if rules.count < 1:
        raise SettingsError(f"count is {rules.count}", where="count", advice="draw at least one segment")
    for name in ("length", "period"):
        value = getattr(rules, name)
        if not (math.isfinite(value) and value > 0):
            raise SettingsError(f"{name} is {value}", where=name, advice="give a positive number of seconds")
    variances = np.concatenate((noise.psd, noise.start))
    if not (np.isfinite(variances).all() and variances.min() >= 0):
        raise SettingsError("a variance is negative or not finite", where="noise", advice="give zero or more")

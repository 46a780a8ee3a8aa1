# SPDX-License-Identifier: Apache-2.0
"""A simulated car commanded by throttle and steering, as a table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

STEP = 0.05  # s, between commands


def true_car() -> _core.CarCurves:
    """A car with a dead zone, an offset of its steering, drag in turns and understeer."""
    speed = _core.KnotCurve([-1.0, 0.0, 0.2, 0.6, 1.0], [-1.0, 0.0, 0.0, 2.0, 2.6], [0.0] * 5)
    curvature = _core.KnotCurve([-1.0, 0.0, 1.0], [-1.9, 0.1, 1.6], [0.0] * 3)
    return _core.CarCurves(speed, curvature, 0.4, 0.1, 0.15, 0.08)


def changed_car(speed: float = 1.0, curvature: float = 1.0) -> _core.CarCurves:
    """The same car so many times as fast at each throttle, and so many times as tight at each steering."""
    car = true_car()
    of_speed, of_turn = (
        _core.KnotCurve(curve.at, [factor * value for value in curve.value], curve.std)
        for curve, factor in ((car.speed, speed), (car.curvature, curvature))
    )
    return _core.CarCurves(of_speed, of_turn, car.lag, car.steering_lag, car.cornering_drag, car.understeer)


def commands(
    seconds: float, seed: int, fastest: float = 0.8
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Stamps [N] s, throttle and steering [N], each held for 1.5 s."""
    rng = np.random.default_rng(seed)
    count = round(seconds / STEP)
    held = np.arange(count) // 30
    return (
        np.arange(count) * STEP,
        rng.uniform(0.0, fastest, held[-1] + 1)[held],
        rng.uniform(-1.0, 1.0, held[-1] + 1)[held],
    )


def write_car_log(
    path: Path,
    seconds: float = 120.0,
    seed: int = 1,
    *,
    largest: float = 1.0,
    car: _core.CarCurves | None = None,
    fastest: float = 0.8,
) -> Path:
    """Write a table with throttle up to `fastest` (times `largest`), steering and poses to 2 mm."""
    rng = np.random.default_rng(seed + 1000)
    t, throttle, steering = commands(seconds, seed, fastest)
    told = _core.InputHistory(t, throttle, np.zeros_like(t), steering)
    twists = (car or true_car()).twists(told, 0.0, None).rows()
    pose, rows = _core.Pose2(0.0, 0.0, 0.0), []
    for k, (at, v, vy, omega) in enumerate(twists.tolist()[: len(t)]):
        x, y, yaw = pose.vector() + rng.normal(0.0, 0.002, 3)
        rows.append(f"{at:.3f},{largest * throttle[k]:.6f},{steering[k]:.6f},{x:.6f},{y:.6f},{yaw:.6f}")
        pose = _core.compose(pose, _core.exp(np.array([v, vy, omega]) * STEP))
    path.write_text("\n".join(("t,throttle,steering,x,y,yaw", *rows)) + "\n", encoding="utf-8")
    return path

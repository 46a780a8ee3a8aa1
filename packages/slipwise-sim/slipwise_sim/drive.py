# SPDX-License-Identifier: Apache-2.0
"""Command scripts for a simulated robot: circles and random driving as in the thesis, steps, or dull."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs

COMMAND_RATE = 20.0  # [Hz]
CIRCLE_SPEEDS = (0.5, 1.0, 2.0)  # [m/s]
CIRCLE_CURVATURES = (0.1, 0.25, 0.5)  # [1/m], driven to both sides
CIRCLE_FRACTION = 0.6  # [1] part of the duration spent on circles
CIRCLE_TIME = 10.0  # [s] the longest stay on one circle
SHORTEST_CIRCLE = 5.0  # [s] a short drive leaves circles out rather than stay shorter
BLEND_TIME = 1.5  # [s] from one random manoeuvre to the next
TOP_SPEED = 2.0  # [m/s]
TOP_REVERSE = 1.0  # [m/s]
TOP_YAW_RATE = 1.0  # [rad/s]
TOP_CURVATURE = 0.6  # [1/m]
STEP_TIME = (0.8, 3.0)  # [s] between steps
CREEP_FRACTION = 0.25  # [1] of the steps that creep
CREEP = 0.15  # [1] how fast these are at most, of the top

Drive = Callable[[int, float], Inputs]


def thesis_drive(seed: int, duration: float) -> Inputs:
    """Circles at three speeds times three curvatures to both sides in random order, then random driving.

    Args:
        seed: of the order of the circles and of the random driving.
        duration: length [s].

    Returns:
        Commands at 20 Hz, shape [N].

    Raises:
        SettingsError: the duration is not positive and finite.
    """
    t = _stamps(duration)
    rng = np.random.Generator(np.random.PCG64(seed))
    circles = [
        (speed, side * curvature * speed)
        for speed, curvature, side in itertools.product(CIRCLE_SPEEDS, CIRCLE_CURVATURES, (1, -1))
    ]
    targets = np.array(circles)[rng.permutation(len(circles))]
    stay = np.clip(CIRCLE_FRACTION * duration / len(circles), SHORTEST_CIRCLE, CIRCLE_TIME)
    place = (t / stay).astype(np.int64)
    on_circles = (t < CIRCLE_FRACTION * duration) & (place < len(circles))
    last = targets[place[on_circles]][-1:]
    commands = _random_driving(rng, t - on_circles.sum() / COMMAND_RATE, last)
    commands[on_circles] = targets[place[on_circles]]
    return _inputs(t, commands)


def dull_drive(seed: int, duration: float) -> Inputs:
    """Straight ahead at one speed: a drive from which little can be learned. The seed changes nothing.

    Raises:
        SettingsError: the duration is not positive and finite.
    """
    del seed
    return hold(1.0, 0.0, duration)


def steps_drive(seed: int, duration: float) -> Inputs:
    """Steps of speed and yaw rate, large and creeping ones: they show dead-band, top speed and rate limits.

    Raises:
        SettingsError: the duration is not positive and finite.
    """
    t = _stamps(duration)
    rng = np.random.Generator(np.random.PCG64(seed))
    ends = np.cumsum(rng.uniform(*STEP_TIME, int(duration / STEP_TIME[0]) + 1))
    scale = np.where(rng.random((len(ends), 2)) < CREEP_FRACTION, CREEP, 1.0)
    targets = scale * rng.uniform(-1.0, 1.0, (len(ends), 2)) * (TOP_SPEED, 1.5 * TOP_YAW_RATE)
    return _inputs(t, targets[np.searchsorted(ends, t, side="right")])


def hold(v: float, omega: float, duration: float) -> Inputs:
    """One command [m/s, rad/s] for the whole duration [s], at 20 Hz.

    Raises:
        SettingsError: the duration is not positive and finite.
    """
    t = _stamps(duration)
    return _inputs(t, np.tile((float(v), float(omega)), (t.size, 1)))


DRIVES: MappingProxyType[str, Drive] = MappingProxyType(
    {"thesis": thesis_drive, "steps": steps_drive, "dull": dull_drive}
)


def _stamps(duration: float) -> NDArray[np.float64]:
    if not (np.isfinite(duration) and duration > 0):
        raise SettingsError(f"duration is {duration}", where="duration", advice="give a positive number")
    return np.arange(int(np.ceil(duration * COMMAND_RATE - 1e-9))) / COMMAND_RATE


def _inputs(t: NDArray[np.float64], commands: NDArray[np.float64]) -> Inputs:
    return Inputs(t=t, v=commands[:, 0].copy(), vy=np.zeros_like(t), omega=commands[:, 1].copy())


def _random_driving(
    rng: np.random.Generator, t: NDArray[np.float64], before: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Manoeuvres of 2 to 8 s from the command `before` [1, 2] on, each smoothly blended into the next.

    Returns the commands [N, 2] at the times t [N]; only those at t >= 0 are meant.
    """
    starts: list[float] = [0.0]
    targets: list[tuple[float, float]] = []
    while not targets or starts[-1] < t[-1]:
        target, stay = _manoeuvre(rng)
        targets.append(target)
        starts.append(starts[-1] + stay)
    current = np.searchsorted(starts[1:], t, side="right").clip(max=len(targets) - 1)
    ramp = np.clip((t - np.array(starts)[current]) / BLEND_TIME, 0.0, 1.0)
    fraction = (ramp * ramp * (3 - 2 * ramp))[:, None]
    points = np.concatenate([before, np.array(targets).reshape(-1, 2)])
    blended: NDArray[np.float64] = (1 - fraction) * points[current] + fraction * points[current + 1]
    return blended


def _manoeuvre(rng: np.random.Generator) -> tuple[tuple[float, float], float]:
    """Draw what to do next: (speed, yaw rate) and for how long [s]."""
    kind, size, turn = rng.random(), rng.random(), rng.uniform(-1.0, 1.0)
    stay = float(rng.uniform(3.0, 8.0))
    if kind < 0.10:
        return (0.0, 0.0), 2.0 + stay / 8
    if kind < 0.25:
        yaw_rate = np.copysign(0.3 + (TOP_YAW_RATE - 0.3) * size, turn)
        return (0.0, float(yaw_rate)), stay
    speed = 0.3 + (TOP_SPEED - 0.3) * size
    if kind < 0.40:
        speed = -0.3 - (TOP_REVERSE - 0.3) * size
    yaw_rate = np.clip(TOP_CURVATURE * turn * abs(speed), -TOP_YAW_RATE, TOP_YAW_RATE)
    return (float(speed), float(yaw_rate)), stay

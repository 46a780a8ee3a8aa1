# SPDX-License-Identifier: Apache-2.0
"""A long drive with known slip and noisy poses, made with the core's integrator, as long as wanted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs import Inputs, Log, Poses, Run

Floats = NDArray[np.float64]

RATE = 20.0  # Hz, inputs and poses
BASIS = "odd-even-10"
# One value per term of the basis: lon V, V|w|, sgn(V)w^2; lat w, Vw, w|w|; ang w, Vw, w|w|, V.
SLIP = np.array([-0.05, -0.02, 0.01, 0.06, 0.02, -0.03, -0.35, 0.02, 0.05, 0.01])
POSE_STD_XY, POSE_STD_YAW = 0.01, 0.003  # m, rad
CHUNK = 12_000  # steps integrated at a time


SlipNoise = Callable[[int, np.random.Generator], Floats]  # slip rates [N, 3] at every step


@dataclass(frozen=True)
class Answer:
    """How the drive follows commands, in place of wheel speeds that are known."""

    delay: float = 0.2  # s
    lag: float = 0.3  # s, of first order


def simulated_log(
    minutes: float,
    *,
    seed: int,
    slip_noise: SlipNoise | None = None,
    slips: Sequence[Floats] = (SLIP,),
    answer: Answer | None = None,
) -> Log:
    """Return a log of one run: held random wheel speeds, the poses they lead to, and pose noise.

    The slip parameters are `slips` in turn, each for the same fraction of the time. With an `answer` the log
    holds commands instead, which the drive follows.
    """
    rng = np.random.default_rng(seed)
    count = round(minutes * 60.0 * RATE)
    t = np.round(np.arange(count) / RATE, 3)
    v, omega = _held_inputs(count, rng)
    twist = np.column_stack((v, np.zeros(count), omega))
    if answer is not None:
        twist = _answered(twist, answer)
    if slip_noise is not None:
        twist = twist + slip_noise(count, rng)
    x, y, yaw = _poses(twist, slips)
    inputs = Inputs(t=t, v=v, vy=np.zeros(count), omega=omega)
    yaw = yaw + POSE_STD_YAW * rng.standard_normal(count)
    poses = Poses(
        t=t,
        x=x + POSE_STD_XY * rng.standard_normal(count),
        y=y + POSE_STD_XY * rng.standard_normal(count),
        yaw=np.arctan2(np.sin(yaw), np.cos(yaw)),
        frame=np.zeros(count, np.int64),
    )
    commands, wheels = (None, inputs) if answer is None else (inputs, None)
    return Log((Run(name=f"simulated{minutes:g}min", commands=commands, wheels=wheels, poses=poses),))


def _answered(twist: Floats, answer: Answer) -> Floats:
    """Return what the drive makes of commanded twists [N, 3]: late, then a lag of first order."""
    late, keep = round(answer.delay * RATE), np.exp(-1.0 / (RATE * answer.lag))
    driven, now = np.zeros_like(twist), np.zeros(3)
    for i in range(len(twist)):
        now = keep * now + (1.0 - keep) * (twist[i - late] if i >= late else 0.0)
        driven[i] = now
    return driven


def _held_inputs(count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return speeds and yaw rates that are held for 1 to 4 s each, one drive in four backwards."""
    lengths = rng.integers(round(RATE), round(4 * RATE), size=count // round(RATE) + 1)
    speed = rng.uniform(0.3, 2.0, len(lengths)) * rng.choice((1.0, 1.0, 1.0, -1.0), len(lengths))
    turn = speed * rng.uniform(-0.5, 0.5, len(lengths))
    return np.repeat(speed, lengths)[:count], np.repeat(turn, lengths)[:count]


def _poses(twist: Floats, slips: Sequence[Floats]) -> tuple[Floats, Floats, Floats]:
    """Integrate twists [N, 3] exactly, in chunks; return x, y [m] and yaw [rad] at every sample."""
    model = _core.MotionModel(_core.named_basis(BASIS), False, False)
    parts, origin = [], np.zeros(3)
    for slip, fraction in zip(slips, np.array_split(twist, len(slips)), strict=True):
        for begin in range(0, len(fraction), CHUNK):
            v, vy, omega = fraction[begin : begin + CHUNK].T.copy()
            t = np.arange(len(v)) / RATE
            history = _core.InputHistory(t, v, vy, omega)
            segment = _core.Segment(0.0, len(v) / RATE, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
            path = _core.integrate_segment(model, slip, history, segment, _core.Integrator.Exact)
            world = _moved(origin, path.poses)
            parts.append(world[:-1])
            origin = world[-1]
    x, y, yaw = np.concatenate(parts).T
    return x, y, yaw


def _moved(origin: Floats, poses: Floats) -> Floats:
    """Return poses seen from `origin`, [N, 3], in the frame that the origin is given in."""
    c, s = np.cos(origin[2]), np.sin(origin[2])
    x = origin[0] + c * poses[:, 0] - s * poses[:, 1]
    y = origin[1] + s * poses[:, 0] + c * poses[:, 1]
    return np.column_stack((x, y, origin[2] + poses[:, 2]))

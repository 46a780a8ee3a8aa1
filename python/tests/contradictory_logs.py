# SPDX-License-Identifier: Apache-2.0
"""Logs for tests whose poses and inputs cannot both be right, each made from a sound one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.logs.held import UNKNOWN_AFTER, HeldSum

#: A robot that turns 60 % of what its wheels say and answers commands late: real, and no contradiction.
SKID_STEERED = Drive(
    seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(-0.05, -0.4), lag=0.2, speeds=(-0.2, 1.5)
)


def sound_log(drive: Drive = SKID_STEERED) -> Log:
    """The log that the others are made from."""
    return simulated_log(drive)


def with_runs(log: Log, change: Callable[[Run], Run]) -> Log:
    """Return the log with every run changed."""
    return replace(log, runs=tuple(map(change, log.runs)))


def scaled(log: Log, name: str, factor: float) -> Log:
    """Multiply the speed of the commands or the wheels."""

    def change(run: Run) -> Run:
        inputs = getattr(run, name)
        assert isinstance(inputs, Inputs)
        return replace(run, **{name: replace(inputs, v=inputs.v * factor)})

    return with_runs(log, change)


def turned(log: Log, angle: float, since: float = 0.0) -> Log:
    """Turn the heading of every pose by `angle` [rad], from the time `since` [s] on."""
    return with_poses(log, lambda p: replace(p, yaw=p.yaw + angle * (p.t >= since)))


def stopped(log: Log, since: float, jitter: float = 0.0) -> Log:
    """Hold the poses from the time `since` [s] on, but for `jitter` [m] of noise."""
    rng = np.random.default_rng(3)

    def change(p: Poses) -> Poses:
        at = np.minimum(np.arange(len(p)), int(np.searchsorted(p.t, since)))
        x, y = (column[at] + jitter * rng.standard_normal(len(p)) for column in (p.x, p.y))
        return replace(p, x=x, y=y, yaw=p.yaw[at] + 0.3 * jitter * rng.standard_normal(len(p)))

    return with_poses(log, change)


def circular(log: Log) -> Log:
    """Put the wheels' own path in the place of the poses."""

    def change(run: Run) -> Run:
        assert run.wheels is not None
        return replace(run, poses=dead_reckoned(run.wheels))

    return with_runs(log, change)


def dead_reckoned(wheels: Inputs) -> Poses:
    """Integrate wheel speeds, held between their stamps, to poses at these stamps."""
    plain = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    history = _core.InputHistory(wheels.t, wheels.v, wheels.vy, wheels.omega)
    origin = _core.Pose2(0.0, 0.0, 0.0)
    whole = _core.Segment(float(wheels.t[0]), float(wheels.t[-1]), origin, None, 0.0, 0.0)
    path = _core.integrate_segment(plain, np.zeros(0), history, whole, _core.Integrator.Exact)
    x, y, yaw = np.ascontiguousarray(path.poses.T)
    return Poses(t=wheels.t, x=x, y=y, yaw=yaw, frame=np.zeros(len(wheels), dtype=np.int64))


def with_poses(log: Log, change: Callable[[Poses], Poses]) -> Log:
    """Return the log with the poses of every run changed."""
    return with_runs(log, lambda run: replace(run, poses=change(run.poses)))


def teleported(p: Poses) -> Poses:
    """Every third pose is somewhere else for a while, such as of a localiser that finds itself anew."""
    rng = np.random.default_rng(2)
    away = np.repeat(rng.uniform(-20.0, 20.0, (len(p) // 2 + 1, 2)), 2, axis=0)[: len(p)]
    return replace(p, x=p.x + away[:, 0], y=p.y + away[:, 1])


def since(log: Log, change: Callable[[Log], Log], t: float) -> Log:
    """Return the log with the wheels, commands and poses of another from a time on [s]."""

    def joined(a: Any, b: Any, names: tuple[str, ...]) -> Any:
        return replace(a, **{name: np.where(a.t < t, getattr(a, name), getattr(b, name)) for name in names})

    def change_run(run: Run) -> Run:
        (other,) = change(replace(log, runs=(run,))).runs
        inputs = {
            name: joined(getattr(run, name), getattr(other, name), ("v", "vy", "omega"))
            for name in ("commands", "wheels")
        }
        return replace(run, poses=joined(run.poses, other.poses, ("x", "y", "yaw")), **inputs)

    return with_runs(log, change_run)


def filtered(run: Run, after: float, *, heading: bool = True, every: float = 0.0) -> Run:
    """Give a run the poses of a filter that adds the wheels' motion to its pose, and then takes in the run's.

    Args:
        run: what is changed where it has wheels.
        after: time constant of the filter's corrections [s].
        heading: it corrects the heading so too; otherwise a gyro gives it.
        every: [s] it is corrected whole in one step, instead of slowly.
    """
    if run.wheels is None or len(run.wheels) < 2 or len(run.poses) < 2:
        return run
    w, p = run.wheels, run.poses
    ahead, aside, turns = (
        HeldSum.of(w, each, UNKNOWN_AFTER).between(p.t[:-1], p.t[1:]) for each in (w.v, w.vy, w.omega)
    )
    measured = np.column_stack((p.x, p.y, np.unwrap(p.yaw)))
    rows, corrected = [measured[0]], float(p.t[0])
    for k, dt in enumerate(np.diff(p.t).tolist()):
        way = complex(ahead[k], aside[k]) * np.exp(1j * (rows[-1][2] + 0.5 * turns[k]))
        now = rows[-1] + np.array([way.real, way.imag, turns[k]])
        whole = every > 0.0 and p.t[k + 1] - corrected > every
        corrected = float(p.t[k + 1]) if whole else corrected
        now += (float(whole) if every else 1.0 - np.exp(-dt / after)) * (measured[k + 1] - now)
        now[2] = now[2] if heading else measured[k + 1, 2]
        rows.append(measured[k + 1] if p.frame[k + 1] != p.frame[k] else now)
    x, y, yaw = np.array(rows).T
    return replace(run, poses=replace(p, x=x, y=y, yaw=yaw))

# SPDX-License-Identifier: Apache-2.0
"""Logs for tests: drives simulated by the core from known slip, lag and delay, and small logs by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs import Inputs, Log, Poses, Run

Floats = NDArray[np.float64]

STEP = 0.05  # s, inputs and poses at 20 Hz
PLAIN = _core.Basis("none", [], [], [])


@dataclass(frozen=True)
class Drive:
    """How to simulate a drive."""

    seconds: float = 120.0
    seed: int = 1
    basis: _core.Basis = PLAIN
    alpha: tuple[float, ...] = ()  # true slip parameters
    lag: float = 0.0  # s
    delay: float = 0.0  # s
    late: float = 0.0  # s, how much later the poses are stamped than the inputs
    speeds: tuple[float, float] = (-0.5, 1.5)  # m/s, range of the commands
    yaw_rates: tuple[float, float] = (-0.8, 0.8)  # rad/s
    hold: tuple[int, int] = (10, 50)  # steps between new commands
    pose_std: tuple[float, float] = (0.005, 0.002)  # m, rad
    slip_psd: tuple[float, float, float] = (1e-5, 1e-5, 1e-5)  # m^2/s, m^2/s, rad^2/s
    disturbance: tuple[float, float] | None = (
        None  # std of each of alpha about itself, and its time constant [s]
    )
    name: str = "drive"


def simulated_log(drive: Drive) -> Log:
    """Return a log of one run with commands, wheel speeds (the commands after lag and delay) and poses."""
    return Log(runs=(simulated_run(drive),))


def simulated_run(drive: Drive) -> Run:
    """Simulate the drive step by step with the core's exact step."""
    rng = np.random.default_rng(drive.seed)
    t, v, omega = commands(drive, rng)
    (wheel_v, actual_v), (wheel_omega, actual_omega) = _through_chain(v, drive), _through_chain(omega, drive)
    spread = np.sqrt(np.array(drive.slip_psd) * STEP)
    slip = np.zeros((len(t), 3))
    if len(drive.alpha):
        alphas = np.array(drive.alpha, dtype=np.float64) + _disturbed(drive, len(t))
        drives = zip(actual_v.tolist(), actual_omega.tolist(), strict=True)
        for row, alpha, (speed, rate) in zip(slip, alphas, drives, strict=True):
            row[:] = _core.slip_rate(drive.basis, alpha, _core.SlipState(speed, rate, 0.0, 0.0))
    twists = np.column_stack((actual_v, np.zeros_like(t), actual_omega)) + slip
    pose, path = _core.Pose2(0.3, -0.2, 0.4), np.empty((len(t), 3))
    for row, step in zip(path, twists * STEP + spread * rng.standard_normal(path.shape), strict=True):
        row[:] = pose.vector()
        pose = _core.compose(pose, _core.exp(step))
    path += rng.standard_normal(path.shape) * np.array(
        [drive.pose_std[0], drive.pose_std[0], drive.pose_std[1]]
    )
    still = np.zeros_like(t)
    return Run(
        name=drive.name,
        commands=Inputs(t=t, v=v, vy=still, omega=omega),
        wheels=Inputs(t=t, v=wheel_v, vy=still, omega=wheel_omega),
        poses=poses_of(t + drive.late, path),
    )


def _disturbed(drive: Drive, count: int) -> Floats:
    """Deviations of alpha, first-order Gauss-Markov processes, [count, alpha]."""
    deviations = np.zeros((count, len(drive.alpha)))
    if drive.disturbance is None:
        return deviations
    std, time_constant = drive.disturbance
    rng = np.random.default_rng([drive.seed, 1])
    kept = np.exp(-STEP / time_constant)
    now, drawn = rng.standard_normal(len(drive.alpha)), rng.standard_normal((count, len(drive.alpha)))
    for row, new in zip(deviations, np.sqrt(1.0 - kept**2) * drawn, strict=True):
        row[:] = now
        now = kept * now + new
    return std * deviations


def commands(drive: Drive, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Return stamps and held random speeds and yaw rates, [N] each."""
    count = round(drive.seconds / STEP)
    v, omega = np.zeros(count), np.zeros(count)
    begin = 0
    while begin < count:
        end = min(count, begin + int(rng.integers(*drive.hold)))
        v[begin:end] = rng.uniform(*drive.speeds)
        omega[begin:end] = rng.uniform(*drive.yaw_rates)
        begin = end
    return np.round(np.arange(count) * STEP, 6), v, omega


def poses_of(t: Floats, path: Floats, frame: Sequence[int] | None = None) -> Poses:
    """Return poses from stamps [M] and rows of (x, y, yaw), the yaw wrapped as sensors do."""
    frames = np.zeros(len(t), np.int64) if frame is None else np.array(frame, dtype=np.int64)
    x, y, yaw = (np.array(column, dtype=np.float64) for column in np.asarray(path, dtype=np.float64).T)
    return Poses(
        t=np.array(t, dtype=np.float64),
        x=x,
        y=y,
        yaw=np.arctan2(np.sin(yaw), np.cos(yaw)),
        frame=frames,
    )


def held(t: Sequence[float] | Floats, v: float = 1.0, omega: float = 0.0) -> Inputs:
    """Return constant inputs at the stamps."""
    stamps = np.array(t, dtype=np.float64)
    return Inputs(
        t=stamps,
        v=np.full(len(stamps), v),
        vy=np.zeros(len(stamps)),
        omega=np.full(len(stamps), omega),
    )


def steady_run(
    seconds: float = 20.0,
    v: float = 1.0,
    omega: float = 0.0,
    *,
    pose_rate: float = 10.0,
    name: str = "steady",
) -> Run:
    """A robot that does exactly what it is commanded: constant speed and yaw rate, without noise."""
    t = np.round(np.arange(0.0, seconds + 1e-9, 1.0 / pose_rate), 6)
    path = np.array([_core.exp(np.array([v, 0.0, omega]) * s).vector() for s in t])
    inputs = held(np.round(np.arange(0.0, seconds + 1e-9, STEP), 6), v, omega)
    return Run(name=name, commands=inputs, wheels=inputs, poses=poses_of(t, path))


def with_poses(run: Run, poses: Poses) -> Run:
    """Return the run with other poses."""
    return replace(run, poses=poses)


def inputs_until(inputs: Inputs, t: float) -> Inputs:
    """Return the inputs stamped at `t` [s] or before."""
    return inputs.select(inputs.t <= t)


def log_until(log: Log, t: float) -> Log:
    """Return the log as it would have been recorded until `t` [s]."""
    runs = []
    for run in log.runs:
        poses = run.poses.select(run.poses.t <= t)
        commands, wheels = (None if x is None else inputs_until(x, t) for x in (run.commands, run.wheels))
        if len(poses) > 1:
            runs.append(replace(run, commands=commands, wheels=wheels, poses=poses))
    return replace(log, runs=tuple(runs))


def moved(run: Run, seconds: float) -> Run:
    """Return the run as it would have been recorded so much later."""
    series = {"poses": run.poses, "commands": run.commands, "wheels": run.wheels}
    return replace(run, **{name: replace(s, t=s.t + seconds) for name, s in series.items() if s is not None})


def _through_chain(u: Floats, drive: Drive) -> tuple[Floats, Floats]:
    """The command after a delay of whole steps and a lag: at each stamp, and its mean until the next."""
    steps = round(drive.delay / STEP)
    delayed = np.concatenate([np.zeros(steps), u[: len(u) - steps]]) if steps else u
    if drive.lag == 0.0:
        return delayed, delayed
    decay, output, mean = np.exp(-STEP / drive.lag), np.empty_like(delayed), np.empty_like(delayed)
    fraction = drive.lag * (1.0 - decay) / STEP  # of the start's value in the mean over a step
    now = 0.0
    for i, target in enumerate(delayed.tolist()):
        output[i] = now
        mean[i] = target + (now - target) * fraction
        now = target + (now - target) * decay
    return output, mean

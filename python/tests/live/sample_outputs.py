# SPDX-License-Identifier: Apache-2.0
"""Outputs as a node gives them: a learner is pushed a simulated drive and says what it knows."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from sample_logs import Drive, simulated_run

from slipwise import MotionLearner, Settings, _core
from slipwise.calibration.learned_sequence import SurfaceSummary
from slipwise.calibration.path_ahead import PredictedPath
from slipwise.errors import SettingsError
from slipwise.live.outputs import (
    Floats,
    ModelText,
    MoveNow,
    NextMovesNow,
    Note,
    Odometry,
    Output,
    ParameterNow,
    Path,
    Status,
    SureNow,
    SurfaceNow,
    Validity,
)
from slipwise.logs import Run
from slipwise.models import Model
from slipwise.models.parameter_table import physical_parameters

FRAME, CHILD = "map", "base_link"
HORIZON = 3.0  # s
VEHICLE = "Husky 7"
ALPHA = (-0.08, -0.3)  # forward, yaw: what the simulated robot slips


def odometry_at(t: float, pose: tuple[float, float, float] = (1.0, 2.0, 0.5)) -> Odometry:
    """Return a fused pose with small, correlated covariances."""
    pose_covariance = np.array([[4e-4, 1e-4, 2e-5], [1e-4, 9e-4, -3e-5], [2e-5, -3e-5, 1e-4]])
    return Odometry(
        t=t,
        frame=FRAME,
        child_frame=CHILD,
        pose=np.array(pose),
        pose_covariance=pose_covariance,
        twist=np.array([0.9, -0.01, 0.3]),
        twist_covariance=pose_covariance / 4.0,
        since_pose=0.05,
    )


def straight_path(t: float = 5.0, points: int = 4, *, asked: bool = False) -> Path:
    """Return a path straight ahead whose covariance grows."""
    seconds = np.linspace(0.0, HORIZON, points)
    poses = np.column_stack((seconds, np.zeros(points), np.full(points, 0.1)))
    covariance = np.einsum("n,ij->nij", seconds, np.diag([1e-3, 4e-3, 1e-3]))
    return Path(t=t + seconds, frame=FRAME, poses=poses, covariance=covariance, asked=asked)


def waiting_status(**changes: object) -> Status:
    """Return what a node says before anything has come, with some of it changed."""
    status = Status(
        t=0.0,
        vehicle=VEHICLE,
        input="command",
        state="waiting",
        why="no pose yet",
        validity="unestimated",
        validity_why="nothing was learned yet",
        parameters=(),
        driven=np.empty((0, 3)),
        odometry=None,
        predicted=None,
        slip=None,
        nis=None,
        held_out=None,
        segments=0,
        counts={},
        log=(),
        apply="off",
    )
    return replace(status, **changes)  # type: ignore[arg-type]


def next_moves(t: float = 3.0, **changes: object) -> NextMovesNow:
    """Return three moves worth driving, with some of it changed."""
    moves = (
        MoveNow(1.0, -0.8, 2.0, 0.12, 0.2, "ang.V*w"),
        MoveNow(-0.5, 0.0, 2.0, 0.08, 0.15, "lon.V"),
        MoveNow(0.0, 0.8, 2.0, 0.05, 0.12, "time_constant_omega"),
    )
    sure = (SureNow("yaw", "rad", 0.9, 0.15, 0.03), SureNow("position", "m", 1.0, 0.04, 0.05))
    return replace(NextMovesNow(t, moves, sure, driven_status().parameters), **changes)  # type: ignore[arg-type]


def surface_at(t: float = 3.0, name: str = "sand", probability: float = 0.9) -> SurfaceNow:
    """Return a surface that is likely, beside one that has no name yet."""
    hall = SurfaceSummary("hall", 600.0, 300, 2, "2026-01-02", 1.0, 0.5)
    return SurfaceNow(
        t, name, probability, ((name, probability), ("", 1.0 - probability)), (hall,), (3.0, 2.0)
    )


@functools.cache
def driven_outputs(seconds: float = 40.0) -> tuple[Output, ...]:
    """Return what a node says of a drive with slip, lag and delay: a status a second, odometry at 10 Hz."""
    run = simulated_run(
        Drive(seconds=seconds, seed=4, basis=_core.named_basis("edd-2"), alpha=ALPHA, lag=0.25, delay=0.15)
    )
    return tuple(_driven(run))


def driven_status(seconds: float = 40.0) -> Status:
    """Return the last status of such a drive."""
    return next(output for output in reversed(driven_outputs(seconds)) if isinstance(output, Status))


def _driven(run: Run) -> Iterator[Output]:
    assert run.commands is not None
    learner = MotionLearner("command", Settings())
    learner.start_run("live")
    rng = np.random.default_rng(7)
    c, p = run.commands, run.poses
    log: list[tuple[float, str]] = [(0.0, "commands from /cmd_vel, poses from /amcl_pose")]
    yield Note(0.0, log[0][1])
    model: Model | None = None
    poses = np.column_stack((p.x, p.y, p.yaw))
    for i, t in enumerate(c.t.tolist()):
        learner.push_command(t, c.v[i], c.omega[i])
        learner.push_pose(t, *poses[i].tolist())
        if i % 2 == 0:
            yield odometry_at(t, tuple(poses[i].tolist()))
        if i % 20 == 19:
            changed = learner.events()
            try:
                model = learner.model(limits=False) if changed or model is None else model
            except SettingsError:
                yield waiting_status(t=t, driven=poses[: i + 1])
                continue
            start = max(0, i - 600)
            path = learner.predict([(t, float(c.v[i]), float(c.omega[i]))], horizon=HORIZON)
            predicted = _from(poses[i], path)
            yield predicted
            status = _status(model, t, poses[start : i + 1], (float(c.v[i]), float(c.omega[i])))
            yield replace(
                status,
                predicted=predicted,
                nis=float(rng.chisquare(3)),
                odometry=odometry_at(t, tuple(poses[i].tolist())),
                log=tuple(log),
                counts={"standstill": i // 200, "pose jumps": i // 500, "late input": i // 300},
            )
    yield surface_at()
    assert model is not None
    yield ModelText(float(c.t[-1]), "", model, VEHICLE, "valid", "estimated")


def _from(pose: Floats, path: PredictedPath) -> Path:
    """Return a path, predicted in the frame of its start, in that of the pose it starts from."""
    rows = [
        _core.compose(_core.Pose2(*pose.tolist()), _core.Pose2(*row)).vector() for row in path.poses.tolist()
    ]
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Path(path.t, FRAME, np.array(rows), turn @ path.covariance @ turn.T)


def _status(model: Model, t: float, driven: Floats, command: tuple[float, float]) -> Status:
    content = model.content
    prior = {p.name.removeprefix("log_"): p.prior_std for p in content.parameters}
    rows = []
    for p in physical_parameters(model):
        validity: Validity = "estimated" if p.identified else "unestimated"
        given = p.value if p.identified else None
        log = not any(name == p.name for name in (q.name for q in content.parameters))
        spread = prior.get(p.name, 0.3) * (p.value if log else 1.0)
        rows.append(
            ParameterNow(
                *(p.name, p.unit, p.value, p.std, spread, validity),
                *(0.2 if p.unit == "s" else 0.0, given, p.target_std),
            )
        )
    held = content.verdict.held_out
    return waiting_status(
        t=t,
        state="learning",
        why="",
        validity="estimated" if t > 15.0 else "unestimated",
        validity_why="held-out windows are predicted better than by the baseline"
        if t > 15.0
        else "few windows",
        parameters=tuple(rows),
        driven=driven,
        slip=np.array([-0.08 * command[0], 0.0, -0.3 * command[1]]),
        held_out=None
        if held is None
        else (held.position, held.heading, held.baseline_position, held.baseline_heading),
        segments=content.provenance.learned_segments,
        apply="auto",
    )

# SPDX-License-Identifier: Apache-2.0
"""Predicting where the robot will go, and how sure that is, from a model and the inputs it will be given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs
from slipwise.models.model import Model
from slipwise.models.schema import Tail
from slipwise.student import LEAST_DOF, MOST_DOF

Floats = NDArray[np.float64]

PERIOD = 0.1  # s, between the poses of a predicted path
LONGEST_OFFSET = 10.0  # s; no clock offset is longer


@dataclass(frozen=True, eq=False)
class Path:
    """Poses in the robot's frame at the start, [N] each."""

    t: Floats  # s, in the time of the inputs
    poses: Floats  # [N, 3] x, y [m], yaw [rad], the yaw not wrapped
    covariance: Floats  # [N, 3, 3] parameters, slip noise and the noise of two measured poses
    dof: Floats  # [N] degrees of freedom of the Student t with this covariance; few are heavy tails


def predict(
    model: Model,
    commands: Inputs | ArrayLike,
    *,
    horizon: float,
    start: float | None = None,
    initial: tuple[float, float] | None = None,
) -> Path:
    """Predict the path of base_link under `commands`, wherever on it the pose sensor sits.

    Args:
        model: a learned model.
        commands: held inputs of the kind that the model was learned from: `Inputs`, or rows of
            (t [s], v [m/s], omega [rad/s]), [N, 3]. Those before `start` matter where there is lag or delay.
        horizon: how far to predict [s]; poses are returned every `PERIOD` and at the horizon.
        start: when the prediction starts [s]; by default at the first command.
        initial: the drive's measured (v [m/s], omega [rad/s]) at the start; by default it follows from the
            commands.

    Raises:
        SettingsError: the horizon is not positive, the start lies before the first command, or the commands
            are not such rows.
    """
    model = model.body
    inputs = commands if isinstance(commands, Inputs) else _inputs(commands)
    if not (np.isfinite(horizon) and horizon > 0.0):
        raise SettingsError("the horizon must be positive seconds", advice="such as horizon=5.0")
    begin = float(inputs.t[0]) if start is None else start
    if not (np.isfinite(begin) and begin >= inputs.t[0]):
        raise SettingsError("the start must not lie before the first command", advice="give earlier commands")
    if initial is not None and not np.isfinite(initial).all():
        raise SettingsError("the initial speeds must be finite", advice="such as initial=(0.5, 0.0)")
    track = model.driven(_core.InputTrack(inputs.t, inputs.v, inputs.vy, inputs.omega))
    known = _known_drive(begin, initial)
    ahead = np.append(np.arange(PERIOD, horizon - 1e-9, PERIOD), horizon)
    poses, covariance = [np.zeros(3)], [np.zeros((3, 3))]
    for seconds in ahead.tolist():
        segment = _core.Segment(begin, begin + seconds, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
        if known is not None:
            segment = segment.with_known_drive(*known)
        at = _core.linearize_segment(model.motion, model.mean, track, segment)
        poses.append(at.predicted.vector())
        covariance.append(prediction_covariance(model, at, seconds))
    dof = np.array([tail_at(model, seconds).dof for seconds in (0.0, *ahead.tolist())])
    return Path(begin + np.concatenate(([0.0], ahead)), np.array(poses), np.array(covariance), dof)


def _known_drive(
    begin: float, initial: tuple[float, float] | None
) -> tuple[_core.InputTrack, float, _core.BodyTwist] | None:
    """Speeds measured at `begin`, held while the poses, stamped late, were under way."""
    if initial is None:
        return None
    v, omega = initial
    held = _core.InputTrack(*(np.array([value]) for value in (begin - LONGEST_OFFSET, v, 0.0, omega)))
    return held, begin, _core.BodyTwist(v, 0.0, omega)


def prediction_covariance(model: Model, at: _core.SegmentLinearization, horizon: float) -> Floats:
    """Covariance of one predicted pose, grown as held-out predictions of this horizon [s] needed."""
    scale = np.array(model.content.noise.scale)
    covariance = _core.prediction_covariance(at, model.covariance, model.noise, scale)
    return np.asarray(covariance * tail_at(model, horizon).growth, dtype=np.float64)


def tail_at(model: Model, horizon: float) -> Tail:
    """Growth of the covariance and degrees of freedom at a horizon [s].

    Their logarithms are interpolated between the horizons judged, and kept beyond them; without any, the
    covariance is taken as stated and nearly normal.
    """
    tails = model.content.noise.tails
    if not tails:
        return Tail(growth=1.0, dof=MOST_DOF)
    seconds = sorted(tails)
    growth, dof = (
        np.exp(np.interp(horizon, seconds, [np.log(getattr(tails[s], name)) for s in seconds]))
        for name in ("growth", "dof")
    )
    return Tail(growth=float(growth), dof=float(np.clip(dof, LEAST_DOF, MOST_DOF)))


def _inputs(commands: ArrayLike) -> Inputs:
    try:
        rows = np.asarray(commands, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise _not_rows("are no numbers") from problem
    if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) == 0:
        raise _not_rows(f"have shape {rows.shape}")
    if not np.isfinite(rows).all():
        raise _not_rows("are not finite")
    if not (np.diff(rows[:, 0]) > 0.0).all():
        raise _not_rows("do not go forward in time")
    t, v, omega = (np.ascontiguousarray(column) for column in rows.T)
    return Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega)


def _not_rows(fault: str) -> SettingsError:
    return SettingsError(
        f"commands {fault} where rows of (t, v, omega) are needed, finite and in order of t",
        advice="stack them with numpy.column_stack((t, v, omega))",
    )

# SPDX-License-Identifier: Apache-2.0
"""Where a learner thinks that the robot will be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.calibration.learner import STRUCTURES
from slipwise.errors import SettingsError
from slipwise.models.axes import Axes

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PredictedPath:
    """Where base_link will be, in the frame of its pose at the start."""

    start: float  # s, stamp of the newest measurement
    t: Floats  # [N] s, stamps of the poses; the last is at the horizon
    poses: Floats  # [N, 3] x, y [m], yaw [rad], the yaw not wrapped
    covariance: Floats  # [N, 3, 3] of a Student t each
    dof: Floats  # [N] its degrees of freedom; few are heavy tails
    structure: str  # of the model that predicts: "joint", "cascaded", "direct" or "baseline"


def path_of(path: _core.PredictedPath) -> PredictedPath:
    """Return a path of the core."""
    return PredictedPath(
        start=path.start,
        t=np.array(path.t),
        poses=np.array(path.poses),
        covariance=np.array(path.covariances),
        dof=np.array([student.dof for student in path.students]),
        structure=STRUCTURES[path.structure],
    )


class PathAhead:
    """The predictions of a `MotionLearner`."""

    _limits: _core.ActuatorLimits | None  # that the last model has
    _core: _core.MotionLearner

    @property
    def axes(self) -> Axes:
        """The numbers of its inputs."""
        raise NotImplementedError

    def predict(
        self,
        inputs: Sequence[tuple[float, ...]] | ArrayLike,
        *,
        horizon: float,
        forces: Sequence[tuple[float, float, float]] | ArrayLike = (),
    ) -> PredictedPath:
        """Predict the path of base_link from the newest measurement on, with commands that are on their way.

        The newest stamp is by the clock of the inputs. The drive has the limits that `model` found last since
        the learner was made or loaded; before, lag and delay stand for what limits do.

        Args:
            inputs: what the robot will be given, rows of (t [s], v [m/s], omega [rad/s]), [N, 3]; of a robot
                that drives sideways (t, v, vy, omega), [N, 4]; of a car (t, throttle, steering).
            horizon: how far to predict [s].
            forces: known forces that will push it, rows of (t [s], along x, to the left [m/s^2]), each until
                the next one; without any the last that was pushed goes on.

        Raises:
            SettingsError: inputs or forces are not such rows, the horizon is not positive or longer than an
                hour, nothing was measured yet, or forces are known beside attitudes.
        """
        rows, axes = np.asarray(inputs, dtype=np.float64), self.axes
        if rows.ndim != 2 or rows.shape[1] != 1 + len(axes):
            names = ", ".join(("t", *axes.names))
            raise SettingsError(f"inputs have shape {rows.shape}", advice=f"give rows of ({names})")
        future = np.column_stack((rows[:, 0], axes.twists(rows[:, 1:])))
        pushes = np.asarray(forces, dtype=np.float64)
        if pushes.size and (pushes.ndim != 2 or pushes.shape[1] != 3):
            raise SettingsError(f"forces have shape {pushes.shape}", advice="give rows of (t, x, y)")
        pushes = pushes.reshape(-1, 3)
        try:
            path = self._core.predict(future, horizon, 0.0, pushes, self._limits)
        except ValueError as problem:
            raise SettingsError(str(problem)) from problem
        return path_of(path)

# SPDX-License-Identifier: Apache-2.0
"""Which curvature a robot really holds: what it is commanded against what slip leaves of it, over speeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.axes import refuse_sideways
from slipwise.models.model import Model
from slipwise.planning.limits import Limits, limits_of

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CurvatureMap:
    """Steady driving under held commands on flat terrain, [S, C] over speeds and commanded curvatures.

    Dead-band and top speeds of the drive, where learned, are in it.

    Commands beyond a limit, and beyond the speeds or yaw rates that the model has seen, are NaN.
    """

    speed: Floats  # [S] m/s, commanded
    commanded: Floats  # [C] 1/m, commanded curvature
    held: Floats  # [S, C] 1/m, curvature of the path that is driven
    achieved_speed: Floats  # [S, C] m/s along that path
    sideslip: Floats  # [S, C] rad, between the heading and the path

    def tightest(self) -> tuple[Floats, Floats]:
        """Return the largest curvatures that are held, left and right [1/m], [S] each, NaN for none."""
        left = np.nanmax(np.where(np.isfinite(self.held), self.held, -np.inf), axis=1)
        right = np.nanmin(np.where(np.isfinite(self.held), self.held, np.inf), axis=1)
        return np.where(left > 0.0, left, np.nan), np.where(right < 0.0, -right, np.nan)


def curvature_map(
    model: Model, *, limits: Limits | None = None, speeds: int = 20, curvatures: int = 41
) -> CurvatureMap:
    """Return what curvature the robot holds at what speed and command.

    Args:
        model: a learned model.
        limits: of the commands; by default what the model was learned within.
        speeds: how many, up to the limit.
        curvatures: how many, between the limits of both sides.

    Raises:
        ModelError: the model takes throttle and steering, or its slip depends on a sideways speed.
        SettingsError: too few speeds or curvatures.
    """
    model.refuse_throttle("maps of what can be held")
    refuse_sideways(model, "maps of what can be held")
    if speeds < 1 or curvatures < 2:
        raise SettingsError(
            "the map needs a speed and two curvatures", advice="such as speeds=20, curvatures=41"
        )
    within = limits_of(model) if limits is None else limits
    seen = model.content.range
    speed = np.linspace(0.0, min(within.speed, max(seen.speed)), speeds + 1)[1:]
    commanded = np.linspace(-within.curvature, within.curvature, curvatures)
    fastest = min(within.yaw_rate, max(map(abs, seen.yaw_rate)))
    alpha = model.mean[: model.motion.slip_size]
    result = np.full((3, speeds, curvatures), np.nan)
    for i, v in enumerate(speed.tolist()):
        for j, omega in enumerate((commanded * v).tolist()):
            if abs(omega) <= fastest + 1e-12:
                drive = _core.BodyTwist(v, 0.0, omega)
                drive = drive if model.limits is None else model.limits.settled(drive)
                state = _core.SlipState(drive.v, drive.omega, 0.0, 0.0)
                slip = _core.slip_rate(model.motion.basis, alpha, state)
                along, across, turn = drive.v + slip[0], slip[1], drive.omega + slip[2]
                path = float(np.hypot(along, across))
                result[:, i, j] = (turn / path if path > 0.0 else np.nan, path, np.arctan2(across, along))
    return CurvatureMap(speed, commanded, *result)

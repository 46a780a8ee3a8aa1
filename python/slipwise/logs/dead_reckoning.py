# SPDX-License-Identifier: Apache-2.0
"""The path that the wheels alone would make."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.log import Inputs, Poses


def dead_reckoned(wheels: Inputs) -> Poses:
    """Integrate wheel speeds, held between their stamps, to poses at these stamps."""
    plain = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    history = _core.InputHistory(wheels.t, wheels.v, wheels.vy, wheels.omega)
    origin = _core.Pose2(0.0, 0.0, 0.0)
    whole = _core.Segment(float(wheels.t[0]), float(wheels.t[-1]), origin, None, 0.0, 0.0)
    path = _core.integrate_segment(plain, np.zeros(0), history, whole, _core.Integrator.Exact)
    x, y, yaw = np.ascontiguousarray(path.poses.T)
    return Poses(t=wheels.t, x=x, y=y, yaw=yaw, frame=np.zeros(len(wheels), dtype=np.int64))

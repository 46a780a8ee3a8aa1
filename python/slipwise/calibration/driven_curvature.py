# SPDX-License-Identifier: Apache-2.0
"""How tight the curves are that a robot which steers was commanded, and drove."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.rate_fits import Floats
from slipwise.calibration.shares import COMMANDS, DISTANCE, DURATION, KNOWN_PART, ROTATION, TURN, WHEELS

_SLOW = 0.2  # of the longest way of a window; below that, its turn tells no curve
_FEWEST = 20  # windows that tell one
_PART = 0.98  # of the windows, whose curves are no tighter
_CURVED, _WIDE = 0.1, 0.25  # of the tightest, less is straight on; the part of the others that is wide


def driven_curvature(rows: Floats, *, commands: bool) -> float | None:
    """Return the curvature [1/m] of the tightest curves that were commanded, or steered, and driven.

    Windows of about 1.5 s count, so that no single command does. What turns no tighter for commands that are
    tighter, as a steering at its stop, is as if it had not been commanded: the tightest curves of the body
    count, over what of wide ones arrives.

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        commands: whether the inputs are commands, and not of the wheels.

    Returns:
        None where too few windows tell it.
    """
    first = COMMANDS if commands else WHEELS
    given, driven = np.abs(rows[:, [first, first + ROTATION]]), np.abs(rows[:, [DISTANCE, TURN]])
    known = rows[:, first + 3] > KNOWN_PART * rows[:, DURATION]
    for ways in (given[:, 0], driven[:, 0]):
        known &= (ways > 0.0) & (ways >= _SLOW * np.max(ways[known], initial=0.0))
    if np.count_nonzero(known) < _FEWEST:
        return None
    curves = np.column_stack([turn[known] / way[known] for way, turn in (given.T, driven.T)])
    commanded, turned = np.quantile(curves, _PART, axis=0)
    wide = np.quantile(curves[curves[:, 0] >= _CURVED * commanded], _WIDE, axis=0)
    return float(min(commanded, turned * wide[0] / wide[1])) if wide.all() else None

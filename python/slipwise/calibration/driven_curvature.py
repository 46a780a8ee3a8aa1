# SPDX-License-Identifier: Apache-2.0
"""How tight the curves are that a robot which steers was commanded, and drove."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats
from slipwise.logs.motion_windows import motion_windows

_SLOW = 0.2  # of the longest way of a window; below that, its turn tells no curve
_FEWEST = 20  # windows that tell one
_PART = 0.98  # of the windows, whose curves are no tighter
_CURVED, _WIDE = 0.1, 0.25  # of the tightest, less is straight on; the part of the others that is wide


def driven_curvature(rows: Floats, input_name: str) -> float | None:
    """Return the curvature [1/m] of the tightest curves that were commanded, or steered, and driven.

    Windows of about 1.5 s count, so that no single command does. What turns no tighter for commands that are
    tighter, as a steering at its stop, is as if it had not been commanded: the tightest curves of the body
    count, over what of wide ones arrives.

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        input_name: "command" or "wheel".

    Returns:
        None where too few windows tell it.
    """
    w = motion_windows(rows, input_name)
    given, driven = np.abs(w.forward), w.distance
    clear = np.ones(len(w), dtype=np.bool_)
    for ways in (given, driven):
        clear &= (ways > 0.0) & (ways >= _SLOW * np.max(ways[clear], initial=0.0))
    if np.count_nonzero(clear) < _FEWEST:
        return None
    turned = ((w.rotation, given), (w.turn, driven))
    curves = np.column_stack([np.abs(turn[clear]) / way[clear] for turn, way in turned])
    tightest = np.quantile(curves, _PART, axis=0)
    wide = np.quantile(curves[curves[:, 0] >= _CURVED * tightest[0]], _WIDE, axis=0)
    return float(min(tightest[0], tightest[1] * wide[0] / wide[1])) if wide.all() else None

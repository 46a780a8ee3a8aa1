# SPDX-License-Identifier: Apache-2.0
"""How a trailer behind a robot turns: by way, not by time as a body does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from slipwise import _core
from slipwise.logs.findings.driven_steps import DrivenSteps, fit, lagged, turns

_PARTS = 2  # of a step, in each of which a trailer follows
_BACK = -1e-3  # m in a step; a trailer that is pushed folds
_SETTLED = 4.0  # [m] forwards after which a trailer follows again, wherever it was before
_LAGS_OF_DRIVES = (0.0, 0.3)  # [s] of a robot that follows commands; one follows its wheels at once
_FOLDED = 1.5  # [rad] a trailer folds no further
_LENGTHS = (0.4, 0.55, 0.75, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6)  # [m] from the hitch to the axle
_TURNS = (0.3, 0.45, 0.65, 0.9, 1.25)  # of the inputs' turns, by the robot that tows
_BEHIND = (0.0, 0.3)  # from the robot's axle to the hitch, in lengths
_TRAILERS = np.array(list(product(_LENGTHS, _TURNS, _BEHIND)))
_SCALE = (0.65, 1.5)  # of the turns that a trailer should make; farther off it is none


def after_a_way(steps: DrivenSteps) -> DrivenSteps:
    """Choose the windows of a run that come after a way on which a trailer follows."""
    way = np.cumsum(np.where(steps.forward > 0.0, steps.forward, 0.0))
    lost = (steps.forward < _BACK) | ~steps.known
    since = way - np.maximum.accumulate(np.where(lost, way, 0.0))
    follows = np.append(since, since[-1:]) > _SETTLED
    at = np.clip(np.searchsorted(steps.t, steps.stop), 0, len(steps.t) - 1)
    return replace(steps, chosen=follows[at])


def left_by_trailer(drives: Sequence[DrivenSteps], *, commanded: bool) -> tuple[float, float]:
    """Return the sum of the squares of turns that is left by the best trailer, and how long [m] that is.

    Args:
        drives: with at least one chosen window.
        commanded: the inputs are commands, which the robot that tows may follow late.
    """
    measured = turns(drives)
    best = (float(measured @ measured), 0.0)
    for lag in _LAGS_OF_DRIVES if commanded else _LAGS_OF_DRIVES[:1]:
        towed = [
            _core.towed_turns(
                lagged(each.forward, lag), lagged(each.rotation, lag), _TRAILERS, _FOLDED, _PARTS
            )
            for each in drives
        ]
        pulls = np.concatenate([each.between((each.forward,)) for each in drives])
        turned = np.concatenate([each.between(steps.T) for each, steps in zip(drives, towed, strict=True)])
        for number, column in enumerate(turned.T):
            left, factors = fit(np.column_stack((column, pulls)), measured)
            if left < best[0] and _SCALE[0] < factors[0] < _SCALE[1]:
                best = (left, float(_TRAILERS[number, 0]))
    return best

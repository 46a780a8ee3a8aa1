# SPDX-License-Identifier: Apache-2.0
"""Finds commands that are faster than the drive can be: the wheels stay at one speed, whatever is asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Inputs, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_STEP = 0.1  # s, of the grid
_SETTLED = 1.5  # s for which so much was asked: slow drives have answered by then
_MOVES = 0.02  # m/s or rad/s
_FEWEST = 50  # points of the grid above the cap, and below it
_MORE = 1.15  # times the cap; who asks for less may get it
_FASTEST = 0.8  # quantile of what is asked, above which the cap is looked for
_AT, _MOST_AT = 0.05, 0.8  # of the cap, within which are so many of those that were asked for more
_ABOVE = 0.02  # of all may be faster than the cap
_BELOW, _FOLLOWS = (0.3, 0.9), 0.15  # of the cap; there the drive does what is asked, to so much
_OFTEN = 0.1  # of the driven time


@dataclass(frozen=True)
class _Cap:
    """What a drive does not exceed."""

    speed: float  # m/s or rad/s
    part: float  # of the driven time, in which more was asked for
    asked: float  # m/s or rad/s, the median then


class Saturated(Check):
    """Speeds that are asked for and never reached."""

    kind, family, spoils = "saturated", "drive", False
    of_input = True
    means = "the drive is capped below what is commanded: by its driver or its motors"
    shows = "for a tenth of the driven time more is asked for, and the wheels stay within 5 % of one speed"
    cure = (
        "`vx_max`, `wz_max` (MPPI) or `max_vel_x`, `max_vel_theta` (DWB) of the planner; the driver's limit"
    )

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare what was asked for long enough with what the wheels did, for speed and yaw rate."""
        if whole.input_name != "command":
            return None
        found: list[Finding] = []
        for unit, what, column in (("m/s", "speed", "v"), ("rad/s", "yaw rate", "omega")):
            pairs = [_asked_and_done(run, column, whole.unknown_after) for run in whole.log.runs]
            cap = _cap(*np.concatenate([np.empty((2, 0)), *pairs], axis=1))
            if cap is not None:
                found.append(self.of(cap, what, unit))
        if len(found) < 2:
            return found[0] if found else None
        sentence = "; ".join(each.sentence for each in found)
        return self.found(
            sentence, *(text for each in found for text in each.advice), evidence=found[0].evidence
        )

    @classmethod
    def of(cls, cap: _Cap, what: str, unit: str) -> Finding:
        """Say it of the speed or of the yaw rate."""
        return cls.found(
            f"for {100.0 * cap.part:.0f} % of the driven time a {what} above {cap.speed:.2g} {unit} "
            f"is commanded (half of it above {cap.asked:.2g}), and the wheels stay at "
            f"{cap.speed:.2g}: the drive is saturated",
            f"Let the planner ask for no {what} above {cap.speed:.2g} {unit} (MPPI: vx_max, wz_max; "
            "DWB: max_vel_x, max_vel_theta), or raise the limit of the driver.",
            evidence=cap.speed,
        )


def _asked_and_done(run: Run, column: str, unknown_after: float) -> Floats:
    """Return the least size that was commanded of late in one sense, and what the wheels did, [2, N]."""
    c, w = run.commands, run.wheels
    if c is None or w is None or len(c) < 2 or len(w) < 2:
        return np.empty((2, 0))
    count = int(_SETTLED / _STEP)
    t = np.arange(max(c.t[0], w.t[0]), min(c.t[-1], w.t[-1]), _STEP)
    if len(t) <= count:
        return np.empty((2, 0))
    told, wheels = (_held(series, column, t, unknown_after) for series in (c, w))
    lately = sliding_window_view(told, count + 1)
    least, most = lately.min(axis=1), lately.max(axis=1)  # NaN where a command is not known
    asked = np.where(least > 0.0, least, np.where(most < 0.0, most, 0.0))
    done = np.sign(asked) * wheels[count:]
    good = (np.abs(asked) > _MOVES) & np.isfinite(done)
    return np.stack((np.abs(asked[good]), done[good]))


def _held(inputs: Inputs, column: str, t: Floats, unknown_after: float) -> Floats:
    """Return the value in force at times [N], NaN where none is known."""
    at = np.searchsorted(inputs.t, t, side="right") - 1
    known = t - inputs.t[at] <= unknown_after
    return np.where(known, getattr(inputs, column)[at], np.nan)


def _cap(asked: Floats, done: Floats) -> _Cap | None:
    """Return the speed that is not exceeded; None where the drive does what is asked, or nothing clear."""
    if len(asked) < 2 * _FEWEST:
        return None
    speed = float(np.median(done[asked >= np.quantile(asked, _FASTEST)]))
    if speed < _MOVES:
        return None
    more = asked > _MORE * speed
    less = (asked > _BELOW[0] * speed) & (asked < _BELOW[1] * speed)
    if min(more.sum(), less.sum()) < _FEWEST or more.mean() < _OFTEN:
        return None
    capped = np.abs(done[more] - speed) < _AT * speed
    follows = abs(float(np.median(done[less] / asked[less])) - 1.0) < _FOLLOWS
    if capped.mean() < _MOST_AT or np.mean(done > (1.0 + _AT) * speed) > _ABOVE or not follows:
        return None
    return _Cap(speed, float(more.mean()), float(np.median(asked[more])))

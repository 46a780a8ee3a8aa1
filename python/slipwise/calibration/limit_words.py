# SPDX-License-Identifier: Apache-2.0
"""Which limits of the drive a log does not show, or not clearly, and what would show them, in words."""

from __future__ import annotations

from slipwise import _core
from slipwise.number_text import number_text

_AXES = {
    _core.LimitedAxis.Speed: "speed",
    _core.LimitedAxis.YawRate: "yaw rate",
    _core.LimitedAxis.Side: "each side",
}
LEAST_DEAD_BAND = 1e-3  # m/s or rad/s; no drive's is less, so slower commands need not be tried


def advice_on_limits(search: _core.LimitSearch | None, *, kept: bool, wheels_logged: bool) -> tuple[str, ...]:
    """Return what there is to say of a search for limits: an empty tuple if there was none."""
    if search is None:
        return ()
    warnings = () if kept else doubted_limits(search, wheels_logged=wheels_logged)
    return (*warnings, *limits_advice(search))


def limits_advice(search: _core.LimitSearch) -> tuple[str, ...]:
    """Return one sentence for each kind of limit that no axis shows; beyond what was commanded none can.

    A dead-band that even the slowest commands do not show is none.
    """
    found = {limit.kind for limit in search.found}
    speed, turn = search.reach[0], search.reach[1]
    if speed.fastest == 0.0 and turn.fastest == 0.0:
        return ("No limit of the drive found: it was commanded to stand still.",)
    slowest = tuple(reach if reach > LEAST_DEAD_BAND else 0.0 for reach in (speed.slowest, turn.slowest))
    kinds, most = _core.LimitKind, _pair(speed.fastest, turn.fastest)
    steps = _pair(speed.step, turn.step)
    sentences = {
        kinds.dead_band: f"No dead band found; the smallest commands were {_pair(*slowest)}."
        if any(slowest)
        else "",
        kinds.saturation: f"No saturation found; the largest commands were {most}.",
        kinds.slew_rate_up: f"No acceleration limit found; the largest steps from rest were {steps}.",
        kinds.slew_rate_down: f"No braking limit found; the largest steps to rest were {steps}.",
    }
    return tuple(sentence for kind, sentence in sentences.items() if sentence and kind not in found)


def doubted_limits(search: _core.LimitSearch, *, wheels_logged: bool) -> tuple[str, ...]:
    """Return a sentence about limits that were found, yet not kept, as they predict no better."""
    if not search.found:
        return ()
    names = ", ".join(f"{_AXES[each.axis]}: {each.kind.name.replace('_', ' ')}" for each in search.found)
    remedy = "drive longer" if wheels_logged else "record wheel speeds"
    sentence = (
        f"The drive looks limited ({names}), but these limits do not improve predictions: the model leaves "
        f"them out, and its lags and delays may contain them. To decide, {remedy}."
    )
    return (sentence,)


def _pair(speed: float, turn: float) -> str:
    reached = ((speed, "m/s"), (turn, "rad/s"))
    return " and ".join(f"{number_text(value, 2)} {unit}" for value, unit in reached if value > 0.0)

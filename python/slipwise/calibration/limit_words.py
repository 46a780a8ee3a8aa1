# SPDX-License-Identifier: Apache-2.0
"""Which kinds of limits of the drive a log does not show, and the driving that would, in words."""

from __future__ import annotations

from slipwise import _core
from slipwise.number_text import number_text


def limits_advice(search: _core.LimitSearch) -> tuple[str, ...]:
    """Return one sentence for each kind of limit that no lane shows; beyond what was commanded none can."""
    found = {limit.kind for limit in search.found}
    speed, turn = search.reach[0], search.reach[1]
    if speed.fastest == 0.0 and turn.fastest == 0.0:
        return ("No limit of the drive shows: it was commanded to stand still.",)
    kinds = _core.LimitKind
    sentences = {
        kinds.DeadBand: "No dead-band shows: command less than"
        f" {_pair(speed.slowest, turn.slowest)} to see one.",
        kinds.Top: f"No top speed shows: command more than {_pair(speed.fastest, turn.fastest)} to see one.",
        kinds.Acceleration: "No limit of acceleration shows: step from rest by more than"
        f" {_pair(speed.step, turn.step)} to see one.",
        kinds.Braking: "No limit of braking shows: step to rest from more than"
        f" {_pair(speed.step, turn.step)} to see one.",
    }
    return tuple(sentence for kind, sentence in sentences.items() if kind not in found)


def _pair(speed: float, turn: float) -> str:
    reached = ((speed, "m/s"), (turn, "rad/s"))
    return " or ".join(f"{number_text(value, 2)} {unit}" for value, unit in reached if value > 0.0)

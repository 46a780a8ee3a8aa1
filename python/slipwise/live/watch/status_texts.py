# SPDX-License-Identifier: Apache-2.0
"""A status in the words and numbers that people read, the same on the page and in the terminal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime

from slipwise.live.diagnostics import surface_name
from slipwise.live.outputs import MoveNow, ParameterNow, Status, SureNow
from slipwise.number_text import DASH, estimate_texts, number_text

_CLOCK = 1e8  # s; stamps beyond it count from 1970, smaller ones from some start
_LAST_DAY = 253_402_300_799.0  # s, the end of the year 9999
_MOST_DECIMALS = 3  # of slip and errors: mm and mrad

NOTHING_APPLIED = DASH
SLIP_NAMES = (("forward", "m/s"), ("sideways", "m/s"), ("yaw rate", "rad/s"))


@dataclass(frozen=True)
class ParameterTexts:
    """One row of the table of parameters."""

    name: str
    unit: str
    value: str
    std: str
    prior: str
    start: str
    applied: str
    validity: str


@dataclass(frozen=True)
class ErrorTexts:
    """A held-out error beside the baseline's."""

    name: str
    unit: str
    learned: str
    baseline: str
    ratio: str  # of the two, a dash without baseline
    better: bool


def parameter_texts(parameter: ParameterNow) -> ParameterTexts:
    """Return the row of a parameter; start and applied value have the places of the value."""
    value, std = estimate_texts(parameter.value, parameter.std)
    start, _ = estimate_texts(parameter.start, parameter.std)
    applied = NOTHING_APPLIED
    if parameter.applied is not None:
        applied, _ = estimate_texts(parameter.applied, parameter.std)
    return ParameterTexts(
        name=parameter.name,
        unit="" if parameter.unit == "-" else parameter.unit,
        value=value,
        std=std,
        prior=number_text(parameter.prior_std, 2),
        start=start,
        applied=applied,
        validity=parameter.validity,
    )


def slip_texts(status: Status) -> tuple[str, ...] | None:
    """Return slip now, forward, sideways and about the vertical; None where nothing is predicted."""
    if status.slip is None:
        return None
    return tuple(_rounded(value) for value in status.slip.tolist())


def error_texts(status: Status) -> tuple[ErrorTexts, ...]:
    """Return the held-out errors beside the baseline's; nothing before there are some."""
    if status.held_out is None:
        return ()
    position, heading, baseline_position, baseline_heading = status.held_out
    return (
        _error("position", "m", position, baseline_position),
        _error("heading", "rad", heading, baseline_heading),
    )


def move_text(move: MoveNow) -> str:
    """Return a move in words, such as "backwards 0.50 m/s, turning left 0.80 rad/s": anticlockwise."""
    speed, turn = f"{abs(move.v):.2f} m/s", f"{abs(move.omega):.2f} rad/s"
    side = "left" if move.omega > 0.0 else "right"
    if move.v == 0.0:
        return f"on the spot, turning {side} {turn}"
    way = f"{'forwards' if move.v > 0.0 else 'backwards'} {speed}"
    return f"{way}, straight" if move.omega == 0.0 else f"{way}, turning {side} {turn}"


def after_text(move: MoveNow) -> str:
    """Return how sure the worst prediction is after a move."""
    return f"yaw ± {number_text(move.yaw_std, 2)} rad, position ± {number_text(move.position_std, 2)} m"


def sure_text(sure: SureNow) -> str:
    """Return how sure the worst prediction is, and how sure is enough."""
    now, target = number_text(sure.std, 2), number_text(sure.target_std, 2)
    return f"± {now} {sure.unit}, wanted {target}"


def nis_text(status: Status) -> str:
    """Return the NIS of the newest segment, a dash before there is one."""
    return DASH if status.nis is None else number_text(status.nis, 2)


def stamp_text(t: float) -> str:
    """Return a stamp as the time of day, or as seconds where it counts from some start."""
    if not math.isfinite(t):
        return DASH
    if _CLOCK < t < _LAST_DAY:
        return datetime.fromtimestamp(t, tz=UTC).astimezone().strftime("%H:%M:%S")
    return f"{t:.1f} s"


def _error(name: str, unit: str, learned: float, baseline: float) -> ErrorTexts:
    known = math.isfinite(learned) and math.isfinite(baseline) and baseline > 0.0
    return ErrorTexts(
        name=name,
        unit=unit,
        learned=number_text(learned, 2),
        baseline=number_text(baseline, 2),
        ratio=number_text(learned / baseline, 2) if known else DASH,
        better=known and learned < baseline,
    )


def _rounded(value: float) -> str:
    if not math.isfinite(value):
        return DASH
    text = f"{value:.{_MOST_DECIMALS}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def surface_text(status: Status) -> str:
    """Return the surface that is driven on and its probability; an empty string if none are remembered."""
    now = status.surface
    return "" if now is None else f"{surface_name(now.name)}, {100.0 * now.probability:.0f} %"

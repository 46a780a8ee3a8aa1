# SPDX-License-Identifier: Apache-2.0
"""Numbers, and lists of words, as people read them: a few significant digits, a dash where there is none."""

from __future__ import annotations

import math
from collections.abc import Sequence

DASH = "–"
ROUNDING = 1e-12  # in SI units; what is smaller is the rounding of a computation, not a result
MOST_DECIMALS = 6
NOTHING_BESIDE = 1e-3  # of the largest of several numbers


def list_text(words: Sequence[str], last: str) -> str:
    """Return words as a sentence lists them: commas between them, `last` ("and", "or") before the last."""
    return f" {last} ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def number_text(value: float, digits: int = 3) -> str:
    """Return a number with about `digits` significant digits, a dash where it is not finite."""
    if not math.isfinite(value):
        return DASH
    if abs(value) < ROUNDING:
        return "0"
    decimals = _decimals(value, digits)
    return f"{value:.{max(decimals, 0)}f}" if -3 <= decimals <= MOST_DECIMALS else f"{value:.{digits}g}"


def beside_text(value: float, largest: float) -> str:
    """Return a number beside the largest of its kind: what is nothing beside that is 0, not 1e-09."""
    return number_text(value if abs(value) >= NOTHING_BESIDE * abs(largest) else 0.0)


def span_text(ends: Sequence[float]) -> str:
    """Return the ends of a range, such as `-0.5 to 1.35`."""
    largest = max(map(abs, ends), default=0.0)
    return " to ".join(beside_text(end, largest) for end in ends)


def estimate_texts(value: float, std: float) -> tuple[str, str]:
    """Return a value and its standard deviation to the last place that the standard deviation says.

    That has one significant digit, two where it begins with a 1. What is rounded away entirely is said to be
    below the last place that is shown.
    """
    if not (math.isfinite(value) and math.isfinite(std)):
        return number_text(value), number_text(std)
    if std < ROUNDING:
        return number_text(value), "0"
    decimals = _decimals(std, 1)
    if std * 10.0**decimals < 2.0:
        decimals += 1
    if decimals > MOST_DECIMALS:
        return _unsigned_zero(value, MOST_DECIMALS), f"<{10.0**-MOST_DECIMALS:.{MOST_DECIMALS}f}"
    if decimals < -3:
        return f"{value:.3g}", f"{std:.2g}"
    shown = max(decimals, 0)
    return _unsigned_zero(value, shown), f"{std:.{shown}f}"


def estimate_text(value: float, std: float) -> str:
    """Return a value with its standard deviation, such as `1.68 ± 0.02`."""
    return " ± ".join(estimate_texts(value, std))


def count_text(count: int, noun: str) -> str:
    """Return how many there are of something, such as `1 segment` and `2 segments`."""
    return f"{count} {noun}" + ("" if count == 1 else "s")


def _decimals(value: float, digits: int) -> int:
    return digits - 1 - math.floor(math.log10(abs(value)))


def _unsigned_zero(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text

# SPDX-License-Identifier: Apache-2.0
"""Numbers as people read them: a few significant digits, and a dash where there is none."""

from __future__ import annotations

import math

DASH = "–"


def number_text(value: float, digits: int = 3) -> str:
    """Return a number with about `digits` significant digits, a dash where it is not finite."""
    if not math.isfinite(value):
        return DASH
    if value == 0.0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{max(decimals, 0)}f}" if -3 <= decimals <= 6 else f"{value:.{digits}g}"

# SPDX-License-Identifier: Apache-2.0
"""A text map of the speeds and yaw rates that a robot was driven at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs import Inputs
from slipwise.logs.held import UNKNOWN_AFTER, held_for

SHADES = " ░▒▓█"  # each but the first stands for ten times as long as the one before
LONGEST_SHADE = 10.0  # [s] from here on a cell is full
_MARGIN = 7  # characters left of the map

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class MapSize:
    """Cells of the map; odd numbers give the zero a cell of its own."""

    columns: int = 49
    rows: int = 13


def coverage_map(
    inputs: Sequence[Inputs], *, size: MapSize = MapSize(), unknown_after: float = UNKNOWN_AFTER
) -> tuple[str, ...]:
    """Draw how long the inputs were held at each speed (to the right) and yaw rate (upwards).

    Args:
        inputs: of all runs; may be empty.
        size: cells of the map.
        unknown_after: an input is unknown once it is older than this [s].

    Returns:
        Lines of text: the map with its axes, and what the shades mean.
    """
    used = [series for series in inputs if len(series) > 1]
    if not used:
        return ("There are no inputs to draw.",)
    v, omega = (np.concatenate([getattr(series, name) for series in used]) for name in ("v", "omega"))
    held = np.concatenate([held_for(series, unknown_after) for series in used])
    (v_low, v_high), (omega_low, omega_high) = _range(v), _range(omega)
    seconds, _, _ = np.histogram2d(
        omega,
        v,
        bins=(size.rows, size.columns),
        range=((omega_low, omega_high), (v_low, v_high)),
        weights=held,
    )
    labels = {0: omega_low, size.rows // 2: 0.5 * (omega_low + omega_high), size.rows - 1: omega_high}
    lines = ["omega [rad/s]"]
    for row in reversed(range(size.rows)):
        label = f"{labels[row]:+.2f}" if row in labels else ""
        lines.append(f"{label:>{_MARGIN - 1}} │{''.join(_shade(cell) for cell in seconds[row])}│")
    lines.append(" " * _MARGIN + "└" + "─" * size.columns + "┘")
    lines.append(" " * _MARGIN + _axis((v_low, v_high), size.columns) + "  V [m/s]")
    marks = "  ".join(
        f"{shade} {'under' if i == 0 else 'from'} {LONGEST_SHADE * 10.0 ** (max(i, 1) - 3):g} s"
        for i, shade in enumerate(SHADES[1:])
    )
    lines.append(f"{'':<{_MARGIN}}{marks} in a cell; {held.sum():.0f} s in all")
    return tuple(lines)


def _shade(seconds: float) -> str:
    if seconds <= 0.0:
        return SHADES[0]
    decades = np.floor(np.log10(seconds / LONGEST_SHADE) + 1e-9)
    return SHADES[int(np.clip(len(SHADES) - 1 + decades, 1, len(SHADES) - 1))]


def _range(values: Floats) -> tuple[float, float]:
    """Return the range of an axis: that of the values, about a width of 0.2 at least."""
    low, high = float(values.min()), float(values.max())
    missing = max(0.2 - (high - low), 0.0)
    return low - 0.5 * missing, high + 0.5 * missing


def _axis(span: tuple[float, float], columns: int) -> str:
    """Return the numbers below the map: left end, middle and right end."""
    low, high = span
    left, middle, right = f"{low:+.2f}", f"{0.5 * (low + high):+.2f}", f"{high:+.2f}"
    space = columns + 2 - len(left) - len(middle) - len(right)
    return left + " " * (space // 2) + middle + " " * (space - space // 2) + right

# SPDX-License-Identifier: Apache-2.0
"""Warns of speeds far beyond those that a model was learned from."""

from __future__ import annotations

import math
import warnings
from typing import Any

from numpy.typing import NDArray

from slipwise.errors import UnseenSpeed
from slipwise.models.model import Model
from slipwise.number_text import beside_text, number_text

SIDE = 0.2  # of the largest speed: up to there, a side that was never driven is as good as rest
FAR = 2.0  # times the largest speed of the log: beyond it, terms such as V^2 reach where no data were
REST = 0.02  # m/s, rad/s: no speed is far beyond rest below it


def warn_of_unseen_speeds(model: Model, commands: NDArray[Any], *, stacklevel: int) -> bool:
    """Warn where inputs exceed `FAR` times the range of the model, to either side; return whether any do.

    A throttle has no speed.

    Args:
        model: a learned model.
        commands: [..., axes] speeds [m/s] first, those to the left [m/s] second where there are three axes,
            yaw rates [rad/s] last.
        stacklevel: of the warning, as `warnings.warn` takes it: the caller's own line.
    """
    if model.car is not None or not commands.size:
        return False
    warned = False
    span = model.content.range
    for name, values, seen, unit in (
        ("speed", commands[..., 0], span.speed, "m/s"),
        ("sideways speed", commands[..., 1:-1], span.sideways or (-math.inf, math.inf), "m/s"),
        ("yaw rate", commands[..., -1], span.yaw_rate, "rad/s"),
    ):
        largest = max(abs(end) for end in seen)
        highest, lowest = float(values.max(initial=0.0)), float(values.min(initial=0.0))
        for side, most, end in ((1.0, highest, seen[1]), (-1.0, lowest, seen[0])):
            if side * most > max(FAR * side * end, SIDE * largest, REST):
                warned = True
                warnings.warn(
                    f"a {name} of {number_text(most)} {unit} is far beyond the "
                    f"{beside_text(end, largest)} {unit} that the model has seen: the prediction is a guess "
                    "there. Calibrate from a drive that has such.",
                    UnseenSpeed,
                    stacklevel=stacklevel + 1,
                )
    return warned

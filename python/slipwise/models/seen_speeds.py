# SPDX-License-Identifier: Apache-2.0
"""Warns of speeds far beyond those that a model was learned from."""

from __future__ import annotations

import warnings
from typing import Any

from numpy.typing import NDArray

from slipwise.errors import UnseenSpeed
from slipwise.models.model import Model
from slipwise.number_text import number_text

SIDE = 0.2  # of the largest speed: up to there, a side that was never driven is as good as rest
FAR = 2.0  # times the largest speed of the log: beyond it, terms such as V^2 reach where no data were


def warn_of_unseen_speeds(model: Model, commands: NDArray[Any], *, stacklevel: int) -> None:
    """Warn where inputs exceed `FAR` times the range of the model, to either side; a throttle has no speed.

    Args:
        model: a learned model.
        commands: [..., axes] speeds [m/s] first, yaw rates [rad/s] last.
        stacklevel: of the warning, as `warnings.warn` takes it: the caller's own line.
    """
    if model.car is not None:
        return
    span = model.content.range
    for name, values, seen, unit in (
        ("speed", commands[..., 0], span.speed, "m/s"),
        ("yaw rate", commands[..., -1], span.yaw_rate, "rad/s"),
    ):
        largest = max(abs(end) for end in seen)
        if not values.size or not largest > 0.0:
            continue
        for side, most, end in ((1.0, float(values.max()), seen[1]), (-1.0, float(values.min()), seen[0])):
            if side * most > max(FAR * side * end, SIDE * largest):
                warnings.warn(
                    f"a {name} of {number_text(most)} {unit} is far beyond the {number_text(end)} {unit} "
                    "that the model has seen: the prediction is a guess there. Calibrate from a drive that "
                    "has such.",
                    UnseenSpeed,
                    stacklevel=stacklevel + 1,
                )

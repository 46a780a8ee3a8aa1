# SPDX-License-Identifier: Apache-2.0
"""Warns of speeds far beyond those that a model was learned from."""

from __future__ import annotations

import warnings
from typing import Any

from numpy.typing import NDArray

from slipwise.models.model import Model
from slipwise.number_text import number_text

FAR = 2.0  # times the largest speed of the log: beyond it, terms such as V^2 reach where no data were


def warn_of_unseen_speeds(model: Model, commands: NDArray[Any], *, stacklevel: int) -> None:
    """Warn where inputs exceed `FAR` times the range of the model; throttle and steering have no speeds.

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
        if not values.size:
            continue
        most, known = max(float(values.max()), -float(values.min())), max(abs(end) for end in seen)
        if most > FAR * known > 0.0:
            warnings.warn(
                f"a {name} of {number_text(most)} {unit} is far beyond the {number_text(known)} {unit} that "
                "the model has seen: the prediction is a guess there. Calibrate from a faster drive.",
                UserWarning,
                stacklevel=stacklevel + 1,
            )

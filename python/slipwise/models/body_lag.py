# SPDX-License-Identifier: Apache-2.0
"""How the body lags behind its wheels, where a log showed it."""

from __future__ import annotations

import math

from slipwise import _core
from slipwise.models.model import Model
from slipwise.number_text import estimate_text

_AXES = {"time_constant_v": "speed", "time_constant_omega": "yaw rate"}


def is_body_lag(name: str) -> bool:
    """Whether a parameter of a model that answers from wheel speeds is a lag of the body."""
    return name.removeprefix("log_") in _AXES


def is_hidden_lag(name: str, value: float, std: float) -> bool:
    """Whether a parameter of such a model is a lag that may be none, but a late clock."""
    return is_body_lag(name) and not _core.lag_shows(value, std)


def body_lag_sentences(model: Model) -> list[str]:
    """Say how the body follows its wheels, where a log showed it."""
    rows = {row.name.removeprefix("log_"): row for row in model.vector.rows if model.content.lags}
    said = {
        axis: f"{estimate_text(math.exp(row.value), math.exp(row.value) * row.std)} s"
        for name, axis in _AXES.items()
        if (row := rows.get(name)) is not None and _core.lag_shows(row.value, row.std)
    }
    if not said:
        return []
    alike = len(said) == len(_AXES) and len(set(said.values())) == 1
    constants = [text if alike else f"{text} ({axis})" for axis, text in said.items()]
    constant = " and ".join(dict.fromkeys(constants))
    cause = "tracks, soft tyres, springs or a slow steering"
    return [f"The body follows its wheels with a time constant of {constant}: {cause}."]

# SPDX-License-Identifier: Apache-2.0
"""Reads the commands of which a prediction is asked for."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import numpy as np

from slipwise.live.outputs import Floats


def asked_commands(
    content: str, names: Sequence[str], *, newest: float, horizon: float
) -> tuple[Floats, float]:
    """Return rows of t [s] and the learner's axes, and how far to predict [s].

    Args:
        content: JSON with `commands`, rows of these by the stamps of the samples; or with `ahead`, a list for
            `t`, from now on, and for each axis that is not zero throughout.
        names: of the axes.
        newest: stamp of the newest sample [s].
        horizon: where none is asked for [s].

    Raises:
        ValueError: numbers are missing.
    """
    asked = json.loads(content)
    if not isinstance(asked, dict) or not {"commands", "ahead"} & set(asked):
        raise ValueError(f"it has no commands: give [t, {', '.join(names)}] of each as 'commands'")
    horizon = float(asked.get("horizon") or horizon)
    if "ahead" not in asked:
        rows = np.array(asked["commands"], dtype=np.float64)
    else:
        ahead = dict(asked["ahead"])
        if "steering" in names and "omega" not in names:  # a message has one field for both
            ahead.setdefault("steering", ahead.pop("omega", []))
        unknown = sorted(name for name in set(ahead) - {"t", *names} if any(ahead[name]))
        if unknown:
            raise ValueError(f"the robot takes {', '.join(names)}, not {', '.join(unknown)}")
        count = len(ahead["t"])
        columns = [ahead.get(name) or [0.0] * count for name in names]
        if any(len(column) != count for column in columns):
            raise ValueError(f"give as many numbers of {', '.join(names)} as of t")
        rows = np.column_stack([np.array(ahead["t"], dtype=np.float64) + newest, *columns])
    if not (math.isfinite(horizon) and np.isfinite(rows).all()):
        raise ValueError("a number is not finite")
    return (rows if rows.size else np.zeros((0, 1 + len(names)))), horizon

# SPDX-License-Identifier: Apache-2.0
"""Which logs of a fleet say the same: slip and delays mean something else behind other inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.models.slip_words import AS_COMMANDED
from slipwise.models.summary import SIGNIFICANT

WHEELS, COMMANDS, ALONE, BOTH = "wheel speeds", "commands", "commands alone", "commands and wheel speeds"
GAINS = ("gain_v", "gain_omega")  # of drives that wheel speeds told apart

Columns = Mapping[str, NDArray[Any]]


def by_kind(columns: Columns) -> dict[str, NDArray[Any]]:
    """Return the columns with what each log was learned from, by which parameters are told apart.

    What commands alone tell of slip includes the gain of the drive, which wheel speeds tell apart; where
    all gains that they told are one, it is the same slip. Parameters of the logs whose kind is not that of
    most are named with it.

    Args:
        columns: key, input, parameter, value and std of each row [N].
    """
    gains = np.isin(columns["parameter"], GAINS)
    gained = set(columns["key"][gains])
    off = np.abs(columns["value"][gains].astype(float) - 1.0)
    known_off = off > np.maximum(AS_COMMANDED, SIGNIFICANT * columns["std"][gains].astype(float))
    alone, both = (ALONE, BOTH) if known_off.any() else (COMMANDS, COMMANDS)
    kinds = [
        WHEELS if of == "wheel" else both if key in gained else alone
        for key, of in zip(columns["key"], columns["input"], strict=True)
    ]
    usual = Counter(dict(zip(columns["key"], kinds, strict=True)).values()).most_common(1)[0][0]
    named = [
        name if kind == usual else f"{name} ({kind})"
        for name, kind in zip(columns["parameter"], kinds, strict=True)
    ]
    return dict(columns) | {
        "input": np.array(kinds, dtype=object),
        "parameter": np.array(named, dtype=object),
    }


def logs_of_kinds(columns: Columns) -> Counter[str]:
    """Return the number of logs that were learned from each kind of inputs; empty where none is known."""
    kinds = columns.get("input", np.full(len(columns["key"]), ""))
    return Counter(dict(zip(columns["key"], kinds, strict=True)).values())

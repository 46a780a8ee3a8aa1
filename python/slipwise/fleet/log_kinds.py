# SPDX-License-Identifier: Apache-2.0
"""Which logs of a fleet say the same: slip and delays mean something else behind other inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

BOTH = "commands and wheel speeds"
WORDS = {"wheel": "wheel speeds", "command": "commands alone"}

Columns = Mapping[str, NDArray[Any]]


def by_kind(columns: Columns) -> dict[str, NDArray[Any]]:
    """Return the columns with what each log was learned from, by which parameters are told apart.

    What commands alone tell of slip includes the gain of the drive, which wheel speeds tell apart, and a
    delay to the poses includes how late these are stamped. Parameters of the logs whose kind is not that of
    most are named with it.

    Args:
        columns: key, input and parameter of each row [N].
    """
    rows = list(zip(columns["key"], columns["input"], columns["parameter"], strict=True))
    gained = {key for key, _, name in rows if name in ("gain_v", "gain_omega")}
    kinds = [BOTH if key in gained and of == "command" else WORDS.get(of, of) for key, of, _ in rows]
    usual = Counter(dict(zip(columns["key"], kinds, strict=True)).values()).most_common(1)[0][0]
    named = [
        name if kind == usual else f"{name} ({kind})" for (_, _, name), kind in zip(rows, kinds, strict=True)
    ]
    return dict(columns) | {
        "input": np.array(kinds, dtype=object),
        "parameter": np.array(named, dtype=object),
    }


def logs_of_kinds(columns: Columns) -> Counter[str]:
    """Return the number of logs that were learned from each kind of inputs; empty where none is known."""
    kinds = columns.get("input", np.full(len(columns["key"]), ""))
    return Counter(dict(zip(columns["key"], kinds, strict=True)).values())

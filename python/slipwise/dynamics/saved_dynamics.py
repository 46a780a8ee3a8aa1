# SPDX-License-Identifier: Apache-2.0
"""Parameters of a user's dynamics as a YAML file, and dynamics that begin with such a file."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from slipwise.dynamics.dynamics import Dynamics, Parameter
from slipwise.errors import ModelError
from slipwise.files import write_text_whole
from slipwise.models.yaml_file import read_yaml

if TYPE_CHECKING:
    from slipwise.dynamics.learned_dynamics import LearnedDynamics

SCHEMA = 1


def save_dynamics(learned: LearnedDynamics, path: Path) -> Path:
    """Write what was learned; what was not identified is said to be, and keeps its prior."""
    content = {
        "slipwise_dynamics": SCHEMA,
        "verdict": {"good": learned.good, "sentence": learned.verdict},
        "seconds": round(learned.seconds, 3),
        "states": [state.name for state in learned.dynamics.states],
        "inputs": list(learned.dynamics.inputs),
        "parameters": [
            {
                "name": p.name,
                "unit": p.unit,
                "value": p.value if p.identified else p.prior,
                "std": p.std if p.identified else p.prior_std,
                "identified": p.identified,
            }
            for p in learned.parameters
        ],
    }
    write_text_whole(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True))
    return path


def load_dynamics(path: str | Path, dynamics: Dynamics) -> Dynamics:
    """Return `dynamics` whose parameters begin with those of a file that `LearnedDynamics.save` wrote.

    Raises:
        ModelError: it is no such file, or of dynamics with other names.
    """
    content = read_yaml(Path(path))
    if content.get("slipwise_dynamics") != SCHEMA:
        raise ModelError(
            f"this is not a dynamics file of version {SCHEMA}",
            where=str(path),
            advice="give one that LearnedDynamics.save wrote",
        )
    rows = content.get("parameters")
    found = (
        {row["name"]: row for row in rows if isinstance(row, dict) and "name" in row}
        if isinstance(rows, list)
        else {}
    )
    names = [p.name for p in dynamics.parameters]
    if sorted(found) != sorted(names):
        raise ModelError(
            f"the file has parameters {', '.join(found) or 'none'}, the dynamics {', '.join(names)}",
            where=str(path),
            advice="use the file with the dynamics that it was learned for",
        )
    return replace(
        dynamics, parameters=tuple(_parameter(p, found[p.name], path) for p in dynamics.parameters)
    )


def _parameter(given: Parameter, row: dict[str, Any], path: str | Path) -> Parameter:
    value, std = row.get("value"), row.get("std")
    numbers = [float(n) for n in (value, std) if isinstance(n, int | float) and not isinstance(n, bool)]
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)) or numbers[1] <= 0.0:
        raise ModelError(f"the parameter {given.name} has no value with a deviation", where=str(path))
    return replace(given, value=numbers[0], std=numbers[1])

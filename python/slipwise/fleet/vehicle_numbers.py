# SPDX-License-Identifier: Apache-2.0
"""What one log says of a robot in an engineer's numbers, and whether a fleet holds robots of two types."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.fleet.log_kinds import logs_of_kinds
from slipwise.models.model import Model
from slipwise.models.parameter_table import known
from slipwise.models.slip_words import whole_gains
from slipwise.models.step_response import rises

WORDS = {
    "drives": "drives",
    "turns": "turns",
    "multiplier": "separation multiplier",
    "lag_speed": "lag of speed",
    "lag_turn": "lag of yaw rate",
}
APART = 1.25  # ratio of two neighbouring vehicles from which on they may be of two types
CLEARLY = 3.0  # times the largest ratio inside of either group, as logarithms


@dataclass(frozen=True)
class VehicleNumbers:
    """Numbers of one log; NaN where the log does not tell."""

    drives: float = nan  # of what is commanded, or of what the wheels say
    turns: float = nan
    multiplier: float = nan  # of the wheels' separation: drives over turns
    lag_speed: float = nan  # s until 63 % of a step is there, from commands alone
    lag_turn: float = nan
    error: float = nan  # m after the longest horizon that was judged, on held-out segments
    baseline: float = nan  # the same of the kinematic baseline
    error_heading: float = nan  # rad
    baseline_heading: float = nan


NAMES = tuple(field.name for field in fields(VehicleNumbers))


def vehicle_numbers(model: Model) -> VehicleNumbers:
    """Return the numbers of a model learned from one log."""
    found: dict[str, float] = {}
    if model.motion.slip_size:
        gains = whole_gains(model)
        pairs = (("drives", gains.speed), ("turns", gains.yaw_rate))
        found |= {name: gain.value for name, gain in pairs if gain.identified}
        multiplier = gains.separation
        if multiplier is not None and multiplier.identified and multiplier.value > 0.0:
            found["multiplier"] = multiplier.value
        if model.content.input == "command":
            late = zip(("lag_speed", "lag_turn"), rises(model), strict=True)
            found |= {name: risen[0] for name, risen in late if known(*risen)}
    held_out = model.content.verdict.held_out
    if held_out is not None and held_out.segments:
        found |= {"error_heading": held_out.heading, "baseline_heading": held_out.baseline_heading}
        if not held_out.turns_alone:
            found |= {"error": held_out.position, "baseline": held_out.baseline_position}
    return VehicleNumbers(**found)


def logs_of(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[np.int64]]:
    """Return the rows that stand for the logs of each vehicle, one a log."""
    _, first = np.unique(columns["key"], return_index=True)
    vehicles = columns["vehicle"][first]
    return {vehicle: np.sort(first[vehicles == vehicle]) for vehicle in sorted(set(vehicles.tolist()))}


def median(columns: Mapping[str, NDArray[Any]], name: str, rows: NDArray[np.int64]) -> float:
    """Return the median of a number over logs; NaN where none of them tells it."""
    values = columns[name][rows].astype(float)
    values = values[np.isfinite(values)]
    return float(np.median(values)) if len(values) else nan


def types_apart(columns: Mapping[str, NDArray[Any]]) -> str:
    """Say which vehicles look like another type of robot; empty where the fleet looks like one.

    Vehicles are compared by logs that were learned from what most were. Two groups are of two types where
    the smallest ratio between them is at least `APART`, and, as a logarithm, `CLEARLY` times the largest
    between neighbours and between logs of a vehicle in either group.
    """
    kinds = logs_of_kinds(columns)
    if len(kinds) > 1:
        usual = columns["input"] == kinds.most_common(1)[0][0]
        columns = {name: values[usual] for name, values in columns.items()}
    logs = logs_of(columns)
    best: tuple[float, str] = (0.0, "")
    for name in ("turns", "drives", "multiplier"):
        middle = {vehicle: median(columns, name, rows) for vehicle, rows in logs.items()}
        ordered = sorted((value, vehicle) for vehicle, value in middle.items() if value > 0.0)
        if len(ordered) < 2:
            continue
        steps = np.diff(np.log([value for value, _ in ordered]))
        cut = int(np.argmax(steps))
        inside = max([0.0, *np.delete(steps, cut).tolist(), *_scatter(columns, name, logs)])
        if steps[cut] >= np.log(APART) and steps[cut] >= CLEARLY * inside and steps[cut] > best[0]:
            best = float(steps[cut]), _warning(WORDS[name], ordered[: cut + 1], ordered[cut + 1 :])
    return best[1]


def _scatter(
    columns: Mapping[str, NDArray[Any]], name: str, logs: Mapping[str, NDArray[np.int64]]
) -> list[float]:
    """Return how far the logs of each vehicle typically differ from their median, as logarithms."""
    found = []
    for rows in logs.values():
        values = columns[name][rows].astype(float)
        values = values[values > 0.0]
        if len(values) > 1:
            found.append(float(np.median(np.abs(np.log(values / np.median(values))))))
    return found


def _warning(what: str, low: list[tuple[float, str]], high: list[tuple[float, str]]) -> str:
    def group(of: list[tuple[float, str]]) -> str:
        names = ", ".join(name for _, name in of[:4]) + (f" and {len(of) - 4} more" if len(of) > 4 else "")
        values = f"{of[0][0]:.2f}" if len(of) == 1 else f"{of[0][0]:.2f} to {of[-1][0]:.2f}"
        return f"{names} ({what} {values})"

    return (
        f"These look like two types of robot: {group(low)} and {group(high)}. A prior of two types does "
        "harm: learn each type into a folder of its own (-o)."
    )

# SPDX-License-Identifier: Apache-2.0
"""Comparison with a plain reference implementation, whose mean errors per log lie beside the logs."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from log_score import LogScore

SAME_WINDOWS = 0.02  # the sets of windows count as equal where the kinematic baseline's errors differ by less


@dataclass(frozen=True)
class Reference:
    """The reference's mean errors on one log with one input and horizon, by basis."""

    windows: int
    position: dict[str, float]  # m
    heading: dict[str, float]  # rad

    def best(self, error: str) -> tuple[str, float]:
        """Return the best basis, chosen afterwards, and its error ("position" [m] or "heading" [rad])."""
        errors = self.position if error == "position" else self.heading
        name = min((n for n in errors if n != "none"), key=errors.__getitem__)
        return name, errors[name]


@dataclass(frozen=True)
class Comparison:
    """Ours beside the reference's on one log."""

    log: str
    input: str
    windows: int
    reference_windows: int
    none: tuple[float, float]  # m, rad: the kinematic baseline in our windows
    reference_none: tuple[float, float]
    auto: tuple[float, float]
    best: tuple[str, str]  # the reference's best bases for position and for heading
    reference_best: tuple[float, float]

    @property
    def same_windows(self) -> bool:
        """Whether the kinematic baseline is equally wrong, so that the absolute errors can be compared."""
        pairs = zip(self.none, self.reference_none, strict=True)
        return all(abs(ours - theirs) <= SAME_WINDOWS * theirs + 0.001 for ours, theirs in pairs)

    @property
    def worse(self) -> tuple[bool, bool]:
        """Whether our absolute errors (position, heading) are the larger ones."""
        return (self.auto[0] > self.reference_best[0] + 5e-4, self.auto[1] > self.reference_best[1] + 5e-4)


def read_reference(path: Path) -> dict[tuple[str, str, float], Reference]:
    """Read the reference's figures by (log, input, horizon)."""
    table: dict[tuple[str, str, float], Reference] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            key = (row["log"], row["input"], float(row["horizon"]))
            entry = table.setdefault(key, Reference(int(row["windows"]), {}, {}))
            entry.position[row["basis"]] = float(row["pos_mean_m"])
            entry.heading[row["basis"]] = float(row["yaw_mean_rad"])
    return table


def compare(
    scores: Sequence[LogScore], table: dict[tuple[str, str, float], Reference]
) -> tuple[list[Comparison], list[str]]:
    """Compare all logs that the reference has; return the others' names too."""
    comparisons, missing = [], []
    for score in scores:
        reference = table.get((score.log, score.input, score.horizon))
        if reference is None:
            missing.append(f"{score.log} ({score.input})")
            continue
        none, auto = score.methods["none"], score.methods["auto"]
        position, heading = reference.best("position"), reference.best("heading")
        comparisons.append(
            Comparison(
                log=score.log,
                input=score.input,
                windows=score.all_windows,
                reference_windows=reference.windows,
                none=(none.position, none.heading),
                reference_none=(reference.position["none"], reference.heading["none"]),
                auto=(auto.position, auto.heading),
                best=(position[0], heading[0]),
                reference_best=(position[1], heading[1]),
            )
        )
    return comparisons, missing

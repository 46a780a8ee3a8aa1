# SPDX-License-Identifier: Apache-2.0
"""Where slipwise loses, taken from the raw figures, so that no report can leave it out."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

CLEARLY = 1.1  # a rival counts as better where its mean error is this many times smaller
LEAST_COVERAGE = 0.8  # of the 90 % ellipsoid, on logs with at least this many held-out windows:
FEWEST_WINDOWS = 20


@dataclass(frozen=True)
class Loss:
    """One kind of loss, and where it occurs."""

    what: str
    places: tuple[str, ...]


def losses(folder: Path) -> list[Loss]:
    """Return the losses found in the raw figures of a report's folder."""
    found = []
    for name, find in (("real_logs", _on_real_logs), ("filter_speed", _missed_limits)):
        path = folder / f"{name}.json"
        if path.exists():
            found += find(json.loads(path.read_text(encoding="utf-8")))
    return [loss for loss in found if loss.places]


def _on_real_logs(content: dict[str, Any]) -> list[Loss]:
    found = []
    for k, error in enumerate(("position", "heading")):
        found += [
            _worse_than_plain(content["scores"], error),
            _beaten(content["scores"], error),
            _beside_reference(content["reference"], k, error),
        ]
    return [*found, _overconfident(content["scores"])]


def _worse_than_plain(scores: list[dict[str, Any]], error: str) -> Loss:
    ratios = {_where(s): s["methods"]["auto"][f"{error}_ratio"] for s in scores}
    places = [
        f"{where}: {value:.3f} times its error [{low:.2f}, {high:.2f}]"
        for where, (value, low, high) in ratios.items()
        if value > 1.0
    ]
    return Loss(f"`auto` is worse than the kinematic baseline in {error}", tuple(places))


def _beaten(scores: list[dict[str, Any]], error: str) -> Loss:
    places = []
    for score in scores:
        auto = score["methods"]["auto"][error]
        rivals = {
            n: m[error] for n, m in score["methods"].items() if m["causal"] and n not in ("auto", "none")
        }
        best = min(rivals, key=rivals.__getitem__)
        if auto > CLEARLY * rivals[best]:
            places.append(
                f"{_where(score)}: {best}, {auto / rivals[best]:.2f} times smaller "
                f"({score['windows']} windows)"
            )
    return Loss(f"A fixed method, known only afterwards, has a clearly smaller {error} error", tuple(places))


def _beside_reference(comparisons: list[dict[str, Any]], k: int, error: str) -> Loss:
    places = [
        f"{_where(c)}: {c['auto'][k]:.3f} against {c['reference_best'][k]:.3f}, the baseline misses "
        f"by {c['none'][k]:.3f} in our windows and {c['reference_none'][k]:.3f} in the reference's"
        for c in comparisons
        if c["auto"][k] > CLEARLY * c["reference_best"][k]
    ]
    what = f"The reference's best basis of each log, chosen afterwards, has a clearly smaller {error} error"
    return Loss(what, tuple(places))


def _overconfident(scores: list[dict[str, Any]]) -> Loss:
    fractions = {
        _where(s): s["methods"]["auto"]["coverage"][1] for s in scores if s["windows"] >= FEWEST_WINDOWS
    }
    places = [
        f"{where}: {100 * fraction:.0f} %"
        for where, fraction in fractions.items()
        if fraction < LEAST_COVERAGE
    ]
    return Loss("The 90 % ellipsoid of `auto` holds far fewer of the poses", tuple(places))


def _missed_limits(figures: list[dict[str, Any]]) -> list[Loss]:
    places = [
        f"{f['name']}: {f['milliseconds']:.3g} ms, limit {f['limit']:.3g} ms"
        for f in figures
        if f["limit"] is not None and f["milliseconds"] > f["limit"]
    ]
    return [Loss("A limit of time is missed", tuple(places))]


def _where(figures: dict[str, Any]) -> str:
    return f"{figures['log']} ({figures['input']})"

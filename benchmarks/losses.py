# SPDX-License-Identifier: Apache-2.0
"""Where slipwise loses, taken from the raw figures, so that no report can leave it out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

CLEARLY = 1.1  # a rival counts as better where its mean error is this many times smaller


def losses(folder: Path) -> list[str]:
    """Return one sentence per kind of loss found in the raw figures of a report's folder."""
    sentences = []
    for name, find in (("real_logs", _on_real_logs), ("filter_speed", _missed_limits)):
        path = folder / f"{name}.json"
        if path.exists():
            sentences += find(json.loads(path.read_text(encoding="utf-8")))
    return sentences


def _on_real_logs(content: dict[str, Any]) -> list[str]:
    sentences = []
    for error in ("position", "heading"):
        worse_than_plain, beaten = [], []
        for score in content["scores"]:
            where = f"{score['log']} ({score['input']})"
            auto = score["methods"]["auto"]
            value = auto[f"{error}_ratio"][0]
            if value > 1.0:
                worse_than_plain.append(f"{where}: {value:.2f}")
            rivals = {n: m for n, m in score["methods"].items() if m["causal"] and n not in ("auto", "none")}
            best = min(rivals, key=lambda n: rivals[n][error])
            if auto[error] > CLEARLY * rivals[best][error]:
                beaten.append(f"{where}: {best}, {auto[error] / rivals[best][error]:.2f} times smaller")
        if worse_than_plain:
            sentences.append(
                f"`auto` is worse than the plain model in {error} on {_listed(worse_than_plain)}."
            )
        if beaten:
            sentences.append(
                f"A fixed method, known only afterwards, has a clearly smaller {error} error than `auto` on "
                f"{_listed(beaten)}."
            )
    return [*sentences, *_beside_reference(content["reference"]), *_overconfident(content["scores"])]


def _beside_reference(comparisons: list[dict[str, Any]]) -> list[str]:
    sentences = []
    for k, error in enumerate(("position", "heading")):
        worse = []
        for c in comparisons:
            ours, theirs = c["auto"][k], c["reference_best"][k]
            if ours > CLEARLY * theirs:
                plain = f"of the plain model's {c['none'][k]:.3f} against {c['reference_none'][k]:.3f}"
                worse.append(f"{c['log']} ({c['input']}): {ours:.3f} against {theirs:.3f}, {plain}")
        if worse:
            sentences.append(
                f"The reference's best basis of each log, chosen afterwards, has a clearly smaller {error} "
                f"error than `auto` on {_listed(worse)}."
            )
    return sentences


def _overconfident(scores: list[dict[str, Any]]) -> list[str]:
    wrong = [
        f"{s['log']} ({s['input']}): {100 * s['methods']['auto']['coverage'][1]:.0f} %"
        for s in scores
        if s["windows"] >= 20 and s["methods"]["auto"]["coverage"][1] < 0.8
    ]
    return [f"The 90 % ellipsoid holds less than 80 % of the poses on {_listed(wrong)}."] if wrong else []


def _missed_limits(figures: list[dict[str, Any]]) -> list[str]:
    missed = [
        f"{f['name']}: {f['milliseconds']:.3g} ms, limit {f['limit']:.3g} ms"
        for f in figures
        if f["limit"] is not None and f["milliseconds"] > f["limit"]
    ]
    return [f"A limit of time is missed: {'; '.join(missed)}."] if missed else []


def _listed(items: list[str]) -> str:
    return f"{len(items)} log{'s' if len(items) > 1 else ''}: " + "; ".join(items)

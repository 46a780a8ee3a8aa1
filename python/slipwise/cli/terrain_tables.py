# SPDX-License-Identifier: Apache-2.0
"""What `slipwise terrain` shows, and puts into JSON, about training and labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.cli.output import Column, Output

if TYPE_CHECKING:
    from slipwise.terrain import Answer, TerrainClassifier, Training, Windows

_SENSORS = {"vibration": "IMU", "current": "motor currents", "both": "IMU and motor currents"}


def training_part(training: Training, notes: Sequence[str]) -> dict[str, Any]:
    """Return how a training went, in plain numbers."""
    return {
        "surfaces": training.runs,
        "window": training.classifier.cutting.seconds,
        "scores": {kind: plain_score(score) for kind, score in training.scores.items()},
        "rejections": {
            kind: [asdict(entry) for entry in pool.rejections]
            for kind, pool in training.classifier.pools.items()
        },
        "notes": list(notes),
    }


def show_training(out: Output, training: Training) -> None:
    """Show the accuracy on runs left out, and what it costs to find unknown surfaces."""
    from slipwise.terrain.pool import rejection_at

    surfaces = training.classifier.surfaces
    out.line(", ".join(f"{name}: {count} runs" for name, count in training.runs.items()))
    columns = [Column("sensors"), *(Column(name, right=True) for name in ("windows", "right", "ECE"))]
    columns += [Column(name, right=True, spare=1) for name in surfaces]
    rows = [
        [
            _SENSORS[kind],
            str(score.windows),
            f"{score.accuracy:.3f}",
            f"{score.calibration_error:.3f}",
            *(f"{score.recall[name]:.2f}" for name in surfaces),
        ]
        for kind, score in training.scores.items()
    ]
    out.table(
        f"Windows of {training.classifier.cutting.seconds:g} s in runs left out of learning", columns, rows
    )
    for kind, pool in training.classifier.pools.items():
        if pool.rejections:
            costs = (rejection_at(pool.rejections, share) for share in (0.5, 0.85))
            text = ", ".join(f"{entry.unknown:.0%} costs {entry.known:.0%}" for entry in costs)
            out.line(f"Calling unknown surfaces unknown, of windows on known ones ({_SENSORS[kind]}): {text}")


def labels_part(windows: Windows, answer: Answer, labels: NDArray[np.object_]) -> dict[str, Any]:
    """Return how many windows have which label, and how good these are where the log names surfaces."""
    from slipwise.terrain import UNKNOWN, score_of

    names, counts = np.unique(labels[labels != ""].astype(str), return_counts=True)
    named = (windows.label != "") & (labels != "")
    known = named & np.isin(windows.label.astype(str), answer.surfaces)
    strange = named & ~known
    content: dict[str, Any] = {
        "windows": int(counts.sum()),
        "labels": dict(zip(names.tolist(), counts.tolist(), strict=True)),
    }
    if known.any():
        score = score_of(answer.probability[known], windows.label[known], answer.surfaces)
        given = known & (labels != UNKNOWN)
        right = float((labels[given] == windows.label[given]).mean()) if given.any() else None
        content["score"] = plain_score(score)
        by_sensors = {kind: known & np.array([own == kind for own in answer.kind]) for kind in _SENSORS}
        content["score_by_sensors"] = {
            kind: plain_score(score_of(answer.probability[rows], windows.label[rows], answer.surfaces))
            for kind, rows in by_sensors.items()
            if rows.any()
        }
        content["named"] = {"share": float(given.sum() / known.sum()), "accuracy": right}
    if strange.any():
        content["not_trained"] = {
            "windows": int(strange.sum()),
            "called_unknown": float((labels[strange] == UNKNOWN).mean()),
        }
    return content


def show_labels(out: Output, content: dict[str, Any], classifier: TerrainClassifier, share: float) -> None:
    """Show how often each label was given, what "unknown" costs, and how right the labels are."""
    from slipwise.terrain.pool import rejection_at

    counts = ", ".join(f"{name} {count}" for name, count in content["labels"].items())
    out.line(f"{content['windows']} windows of {classifier.cutting.seconds:g} s: {counts}.")
    for kind, pool in classifier.pools.items():
        if pool.rejections and share > 0.0:
            cost = rejection_at(pool.rejections, share)
            cheaper = rejection_at(pool.rejections, 0.5 * share)
            less = f"; --unknown {0.5 * share:g} makes it {cheaper.known:.0%}"
            out.line(
                f"With {_SENSORS[kind]}, as estimated in training, {cost.unknown:.0%} of windows on unknown "
                f"surfaces are called unknown. Price: {cost.known:.0%} of windows on known surfaces are also "
                f"called unknown{less if cheaper.known < cost.known else ''}."
            )
    if "score" in content:
        named = content["named"]
        for kind, score in content["score_by_sensors"].items():
            out.line(
                f"Against the log's own names: the most probable surface is right in {score['accuracy']:.3f} "
                f"of {score['windows']} windows with {_SENSORS[kind]}, "
                f"expected calibration error {score['calibration_error']:.3f}."
            )
        if named["accuracy"] is not None:
            out.line(f"Labels name {named['share']:.0%} of them, {named['accuracy']:.3f} of these rightly.")
    if "not_trained" in content:
        strange = content["not_trained"]
        out.line(
            f"{strange['called_unknown']:.0%} of {strange['windows']} windows on untrained surfaces "
            "are called unknown."
        )


def plain_score(score: Any) -> dict[str, Any]:
    """Return a score as plain numbers, with None for the recall of a surface that does not occur."""
    content = asdict(score)
    content["recall"] = {name: None if isnan(value) else value for name, value in score.recall.items()}
    return content

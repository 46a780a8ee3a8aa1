# SPDX-License-Identifier: Apache-2.0
"""Writes a terrain classifier as JSON of plain numbers, and reads it with every number checked."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from slipwise.errors import ModelError
from slipwise.files import read_whole, write_text_whole
from slipwise.terrain.classifier import UNKNOWN, TerrainClassifier
from slipwise.terrain.features import CURRENT_FEATURES, vibration_names
from slipwise.terrain.kernel_expert import NEAREST, KernelExpert
from slipwise.terrain.pool import Pool, Rejection
from slipwise.terrain.tree_expert import LEAF, Tree, TreeExpert
from slipwise.terrain.windows import Cutting
from slipwise.validation_text import first_problem

Floats = NDArray[np.float64]

SCHEMA = 1
MOST_BYTES = 64 << 20
DIGITS = 6  # of what is written, significant


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=False)


class _Windows(_Part):
    seconds: float = Field(ge=1.0, le=5.0)
    imu_rate: float = Field(ge=0.0, le=10_000.0)
    drive_rate: float = Field(ge=0.0, le=10_000.0)


class _Vibration(_Part):
    features: list[str]
    mean: list[float]
    scale: list[float]
    width: float = Field(gt=0.0)
    centres: list[list[float]]
    weights: list[list[float]]


class _Tree(_Part):
    feature: list[int]
    threshold: list[float]
    left: list[int]
    right: list[int]
    leaves: list[list[float]]


class _Current(_Part):
    features: list[str]
    trees: list[_Tree] = Field(min_length=1)


class _Rejection(_Part):
    unknown: float = Field(ge=0.0, le=1.0)
    known: float = Field(ge=0.0, le=1.0)
    bound: float = Field(ge=0.0, le=1.0)


class _Pool(_Part):
    vibration: float = Field(ge=0.0)
    current: float = Field(ge=0.0)
    offset: float
    doubt: float = Field(ge=0.0)
    newness: float = Field(ge=0.0)
    rejections: list[_Rejection]


class _File(_Part):
    slipwise_terrain: int
    surfaces: list[str] = Field(min_length=2)
    windows: _Windows
    vibration: _Vibration | None
    current: _Current | None
    pools: dict[str, _Pool] = Field(min_length=1)
    training: dict[str, Any]


def save_classifier(path: Path, classifier: TerrainClassifier, training: dict[str, Any]) -> Path:
    """Write a classifier, with what is worth knowing about its training.

    Raises:
        OutputError: the file cannot be written.
    """
    expert, trees = classifier.vibration, classifier.current
    content = {
        "slipwise_terrain": SCHEMA,
        "surfaces": list(classifier.surfaces),
        "windows": asdict(classifier.cutting),
        "vibration": None
        if expert is None
        else {
            "features": vibration_names(classifier.cutting.imu_rate),
            "mean": _plain(expert.mean),
            "scale": _plain(expert.scale),
            "width": expert.width,
            "centres": _plain(expert.centres),
            "weights": _plain(expert.weights),
        },
        "current": None
        if trees is None
        else {"features": list(CURRENT_FEATURES), "trees": [_plain_tree(tree) for tree in trees.trees]},
        "pools": {kind: asdict(pool) for kind, pool in classifier.pools.items()},
        "training": training,
    }
    write_text_whole(path, json.dumps(content, separators=(",", ":"), allow_nan=False) + "\n")
    return path


def load_classifier(path: Path) -> TerrainClassifier:
    """Read a classifier.

    Raises:
        ModelError: the file is missing, of another version, or not a terrain classifier.
    """
    data = read_whole(path, most=MOST_BYTES, error=ModelError)
    try:
        content = _File.model_validate(_object(data))
        if content.slipwise_terrain != SCHEMA:
            raise ValueError(f"version {content.slipwise_terrain}, this slipwise reads {SCHEMA}")
        return _classifier(content)
    except ValidationError as error:
        raise _not_one(path, first_problem(error)) from error
    except (ValueError, RecursionError) as error:
        raise _not_one(path, str(error)) from error


def _object(data: bytes) -> dict[str, Any]:
    content = json.loads(data)
    if not isinstance(content, dict) or "slipwise_terrain" not in content:
        raise ValueError("no key slipwise_terrain")
    return content


def _not_one(path: Path, reason: str) -> ModelError:
    return ModelError(
        f"not a terrain classifier: {reason}", where=str(path), advice="make it by `slipwise terrain train`"
    )


def _classifier(content: _File) -> TerrainClassifier:
    surfaces, cutting = tuple(content.surfaces), Cutting(**content.windows.model_dump())
    if len(set(surfaces)) < len(surfaces) or {UNKNOWN, ""} & set(surfaces):
        raise ValueError("a surface is named twice, or has a name that is none")
    vibration = current = None
    if content.vibration is not None:
        _same("vibration features", content.vibration.features, vibration_names(cutting.imu_rate))
        vibration = _kernel_expert(content.vibration, len(surfaces))
    if content.current is not None:
        _same("current features", content.current.features, CURRENT_FEATURES)
        current = TreeExpert(tuple(_tree(tree, len(surfaces)) for tree in content.current.trees))
    kinds = _kinds(vibration, current)
    if set(content.pools) != kinds:
        raise ValueError(f"pools of {', '.join(sorted(content.pools))}, not of {', '.join(sorted(kinds))}")
    pools = {kind: _pool(pool) for kind, pool in content.pools.items()}
    return TerrainClassifier(surfaces, cutting, vibration, current, pools)


def _kinds(vibration: KernelExpert | None, current: TreeExpert | None) -> set[str]:
    kinds = {"vibration": vibration is not None, "current": current is not None}
    return {kind for kind, there in (kinds | {"both": all(kinds.values())}).items() if there}


def _kernel_expert(content: _Vibration, surfaces: int) -> KernelExpert:
    width = len(content.features)
    expert = KernelExpert(
        _array("mean", content.mean, (width,)),
        _array("scale", content.scale, (width,)),
        content.width,
        _array("centres", content.centres, (len(content.centres), width)),
        _array("weights", content.weights, (len(content.centres), surfaces)),
    )
    if not (expert.scale > 0.0).all() or len(expert.centres) < NEAREST:
        raise ValueError("a scale is not positive, or there are too few centres")
    return expert


def _tree(content: _Tree, surfaces: int) -> Tree:
    nodes, leaves = len(content.feature), len(content.leaves)
    tree = Tree(
        np.array(content.feature, dtype=np.int64),
        _array("threshold", content.threshold, (nodes,)),
        np.array(content.left, dtype=np.int64),
        np.array(content.right, dtype=np.int64),
        _array("leaves", content.leaves, (leaves, surfaces)),
    )
    if not nodes or tree.left.shape != (nodes,) or tree.right.shape != (nodes,):
        raise ValueError("a tree whose arrays differ in length")
    leaf, own = tree.feature == LEAF, np.arange(nodes)
    inner = ~leaf
    onward = (tree.left > own) & (tree.right > own) & (tree.left < nodes) & (tree.right < nodes)
    named = (tree.feature >= 0) & (tree.feature < len(CURRENT_FEATURES))
    inside = (tree.left >= 0) & (tree.left < leaves)
    if not (onward & named)[inner].all() or not inside[leaf].all():
        raise ValueError("a tree whose nodes lead nowhere")
    return tree


def _pool(content: _Pool) -> Pool:
    rejections = tuple(Rejection(**entry.model_dump()) for entry in content.rejections)
    return Pool(
        content.vibration, content.current, content.offset, content.doubt, content.newness, rejections
    )


def _array(name: str, values: Sequence[Any], shape: tuple[int, ...]) -> Floats:
    widths = {len(row) for row in values} if len(shape) == 2 else set(shape[1:])
    if len(values) != shape[0] or not widths <= set(shape[1:]):
        raise ValueError(f"{name} is not {' by '.join(map(str, shape))} numbers")
    return np.array(values, dtype=np.float64).reshape(shape)


def _same(what: str, found: Sequence[str], wanted: Sequence[str]) -> None:
    if list(found) != list(wanted):
        raise ValueError(f"other {what} than this slipwise computes")


def _plain(values: Floats) -> list[Any]:
    """Return nested lists of numbers with few digits, so that the file stays small."""
    if values.ndim > 1:
        return [_plain(row) for row in values]
    return [float(f"{value:.{DIGITS}g}") for value in values.tolist()]


def _plain_tree(tree: Tree) -> dict[str, Any]:
    return {
        "feature": tree.feature.tolist(),
        "threshold": tree.threshold.tolist(),
        "left": tree.left.tolist(),
        "right": tree.right.tolist(),
        "leaves": np.round(tree.leaves, 4).tolist(),
    }

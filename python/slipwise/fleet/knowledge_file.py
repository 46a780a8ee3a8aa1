# SPDX-License-Identifier: Apache-2.0
"""What one log says of its robot in the terms of every basis, as a JSON file of a fleet's store."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.log_knowledge import (
    BasisKnowledge,
    LearnedNormal,
    LogKnowledge,
    StructureKnowledge,
)

Floats = NDArray[np.float64]


def knowledge_text(knowledge: LogKnowledge) -> str:
    """Return the JSON of what a log says."""
    content = {
        "input": knowledge.input,
        "kept": knowledge.kept,
        "structures": {name: _structure(each) for name, each in knowledge.structures.items()},
    }
    return json.dumps(content, allow_nan=False) + "\n"


def knowledge_from(text: str) -> LogKnowledge:
    """Return what a log says from the JSON of `knowledge_text`.

    Raises:
        ValueError: it is not such a text.
    """
    content = json.loads(text)
    try:
        return LogKnowledge(
            str(content["input"]),
            str(content["kept"]),
            {name: _structure_from(each) for name, each in content["structures"].items()},
        )
    except (KeyError, TypeError, AttributeError, RecursionError) as problem:
        raise ValueError(f"not what a log says: {problem}") from problem


def _structure(known: StructureKnowledge) -> dict[str, Any]:
    return {
        "speeds": list(known.speeds),
        "bases": {
            name: {
                "slip": _normal(basis.slip),
                "weight": basis.weight,
                "noise_scale": basis.noise_scale.tolist(),
            }
            for name, basis in known.bases.items()
        },
        "robot_names": list(known.robot_names),
        "robot": None if known.robot is None else _normal(known.robot),
    }


def _normal(learned: LearnedNormal) -> dict[str, Any]:
    return {
        "mean": learned.mean.tolist(),
        "covariance": learned.covariance.tolist(),
        "prior_mean": learned.prior_mean.tolist(),
        "prior_std": learned.prior_std.tolist(),
    }


def _structure_from(content: dict[str, Any]) -> StructureKnowledge:
    v, omega = content["speeds"]
    return StructureKnowledge(
        (float(_floats(v)), float(_floats(omega))),
        {
            name: BasisKnowledge(
                _normal_from(each["slip"]), float(_floats(each["weight"])), _floats(each["noise_scale"])
            )
            for name, each in content["bases"].items()
        },
        tuple(map(str, content["robot_names"])),
        None if content["robot"] is None else _normal_from(content["robot"]),
    )


def _normal_from(content: dict[str, Any]) -> LearnedNormal:
    mean = _floats(content["mean"])
    size = mean.shape
    if mean.ndim != 1:
        raise ValueError("a mean is not a list of numbers")
    covariance = _floats(content["covariance"]).reshape(size * 2)
    prior_mean, prior_std = _floats(content["prior_mean"]), _floats(content["prior_std"])
    if prior_mean.shape != size or prior_std.shape != size or (np.diag(covariance) < 0.0).any():
        raise ValueError("a prior or a covariance does not go with its mean")
    return LearnedNormal(mean, covariance, prior_mean, prior_std)


def _floats(values: list[float]) -> Floats:
    found = np.array(values, dtype=np.float64)
    if not np.isfinite(found).all():
        raise ValueError("a number is not finite")
    return found

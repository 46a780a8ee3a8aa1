# SPDX-License-Identifier: Apache-2.0
"""A fleet's prior is checked when it is read; what is wrong is named with its key."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from slipwise.errors import ModelError
from slipwise.models.fleet_prior import load_prior


def content() -> dict[str, Any]:
    basis = {"mean": [0.1], "covariance": [[0.01]], "weight": 1.0, "variance_scale": [1.0, 1.0, 1.0]}
    robot = {"parameters": ["clock_offset"], "mean": [0.0], "covariance": [[0.01]]}
    start = {
        "input": "wheel",
        "structure": "joint",
        "speeds": [1.0, 0.5],
        "bases": {"b": basis},
        "robot": robot,
    }
    parameter = {"unit": "-", "mean": 0.1, "std": 0.1, "between_robots_std": 0.05, "robots": 3}
    return {
        "slipwise_fleet_prior": 2,
        "type": "rover",
        "robots": 3,
        "logs": 5,
        "parameters": {"ang.w": parameter},
        "start": start,
    }


def written(path: Path, value: object) -> Path:
    path.write_text(yaml.safe_dump(value))
    return path


def test_a_sound_file_is_read(tmp_path: Path) -> None:
    prior = load_prior(written(tmp_path / "f.yaml", content()))
    assert prior.start is not None
    assert prior.start.bases["b"].covariance == [[0.01]]


WRONG = {
    "covariance": (
        ("start", "bases", "b", "covariance"),
        [[0.01, 0.0]],
        "a row and a column for each number",
    ),
    "not finite": (("start", "bases", "b", "mean"), [float("nan")], "start.bases.b.mean.0"),
    "names": (("start", "robot", "parameters"), [], "each number of the mean needs a name"),
    "structure": (("start", "structure"), "baseline", "start.structure: must be"),
    "speeds": (("start", "speeds"), [0.0, 1.0], "start.speeds.0: must be more than 0"),
    "key": (("extra",), 1, "extra: there is no such key"),
    "older": (("slipwise_fleet_prior",), 1, "a fleet prior of an older slipwise"),
    "bases": (("start", "bases"), {}, "start.bases: needs at least 1"),
}


def test_what_is_wrong_is_named(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for name, (keys, value, message) in WRONG.items():
        with subtests.test(name=name):
            wrong = content()
            inside = wrong
            for key in keys[:-1]:
                inside = inside[key]
            inside[keys[-1]] = value
            with pytest.raises(ModelError, match=message):
                load_prior(written(tmp_path / "f.yaml", wrong))


def test_a_model_file_is_no_prior(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="not a fleet's prior"):
        load_prior(written(tmp_path / "f.yaml", {"slipwise_model": 4}))

# SPDX-License-Identifier: Apache-2.0
"""A classifier comes back from its file with the same answers, and a damaged file is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sample_terrain import made_recordings

from slipwise.errors import ModelError
from slipwise.terrain import Training, cut_windows, load_classifier, save_classifier, train

pytestmark = pytest.mark.skipif(find_spec("sklearn") is None, reason="training needs scikit-learn")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def training() -> Training:
    return train(made_recordings(runs=2, seconds=10.0), seconds=2.0)


@pytest.fixture
def file(training: Training, tmp_path: Path) -> Path:
    return save_classifier(tmp_path / "terrain.json", training.classifier, {"note": "made up"})


def test_a_file_answers_as_what_was_saved(training: Training, file: Path) -> None:
    windows = cut_windows(made_recordings(runs=1, seed=1), training.classifier.cutting, step=1.0)
    loaded = load_classifier(file)
    assert loaded.surfaces == training.classifier.surfaces
    assert loaded.cutting == training.classifier.cutting
    first, second = training.classifier.answer(windows), loaded.answer(windows)
    np.testing.assert_allclose(second.probability, first.probability, atol=2e-3)
    np.testing.assert_allclose(second.unknown, first.unknown, atol=2e-3)


def first_tree(content: dict[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = content["current"]["trees"][0]
    return tree


DAMAGES: dict[str, Callable[[dict[str, Any]], object]] = {
    "version 9, this slipwise reads 1": lambda c: c.update(slipwise_terrain=9),
    "no key slipwise_terrain": lambda c: c.pop("slipwise_terrain"),
    "surfaces": lambda c: c.update(surfaces=["grass"]),
    "named twice": lambda c: c.update(surfaces=["grass", "grass", "tiles"]),
    "or has a name that is none": lambda c: c.update(surfaces=["grass", "unknown", "tiles"]),
    "other vibration features": lambda c: c["vibration"]["features"].pop(),
    "centres is not 30 by 72 numbers": lambda c: c["vibration"].update(centres=[[0.0]] * 30),
    "a scale is not positive": lambda c: c["vibration"]["scale"].__setitem__(0, 0.0),
    "mean is not 72 numbers": lambda c: c["vibration"]["mean"].pop(),
    "must be a number": lambda c: c["vibration"]["mean"].__setitem__(0, "x"),
    "arrays differ in length": lambda c: first_tree(c)["left"].pop(),
    "nodes lead nowhere": lambda c: first_tree(c)["left"].__setitem__(0, 0),
    "threshold is not": lambda c: first_tree(c)["threshold"].pop(),
    "leaves is not": lambda c: first_tree(c)["leaves"][0].pop(),
    "pools of both, current, not of": lambda c: c["pools"].pop("vibration"),
    "windows": lambda c: c["windows"].update(seconds=-1),
    "there is no such key": lambda c: c.update(more=1),
}


@pytest.mark.parametrize("message", DAMAGES)
def test_a_damaged_file_is_refused(file: Path, message: str) -> None:
    content = json.loads(file.read_text())
    DAMAGES[message](content)
    file.write_text(json.dumps(content))
    with pytest.raises(ModelError, match=message) as caught:
        load_classifier(file)
    assert str(caught.value).startswith("not a terrain classifier: ")


@pytest.mark.parametrize(
    "data", [b"", b"[]", b"{", b"\xff\xfe", b"[" * 100_000, b'{"slipwise_terrain": NaN}']
)
def test_what_is_no_such_json_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "terrain.json"
    path.write_bytes(data)
    with pytest.raises(ModelError, match="not a terrain classifier"):
        load_classifier(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="cannot read"):
        load_classifier(tmp_path / "none.json")

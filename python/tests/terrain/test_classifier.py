# SPDX-License-Identifier: Apache-2.0
"""A classifier answers with the sensors that a window has."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import ModelError, SettingsError
from slipwise.terrain import TerrainClassifier, Windows
from slipwise.terrain.classifier import kinds_of
from slipwise.terrain.pool import Pool, Rejection
from slipwise.terrain.tree_expert import LEAF, Tree, TreeExpert
from slipwise.terrain.windows import Cutting

STUMP = Tree(
    np.array([0, LEAF, LEAF]),
    np.array([1.0, 0.0, 0.0]),
    np.array([1, 0, 1]),
    np.array([2, 0, 0]),
    np.array([[0.9, 0.1], [0.45, 0.55]]),
)
POOL = Pool(0.0, 1.0, 0.0, 1.0, 0.0, (Rejection(0.5, 0.1, 0.4), Rejection(0.8, 0.3, 0.05)))
CLASSIFIER = TerrainClassifier(
    ("ice", "sand"), Cutting(1.0, 0.0, 10.0), None, TreeExpert((STUMP,)), {"current": POOL}
)


def windows_of(*currents: float) -> Windows:
    count = len(currents)
    names = np.full(count, "", dtype=object)
    values = np.tile(np.array(currents)[:, None], (1, 16))
    return Windows(names, np.zeros(count), np.ones(count), names, np.full((count, 0), np.nan), values)


def test_the_most_probable_surface_is_named_unless_it_is_unknown() -> None:
    answer = CLASSIFIER.answer(windows_of(0.0, 2.0))
    assert CLASSIFIER.labels(answer, 0.0).tolist() == ["ice", "sand"]
    assert CLASSIFIER.labels(answer, 0.5).tolist() == ["ice", "unknown"]
    assert CLASSIFIER.labels(answer, 0.8).tolist() == ["unknown", "unknown"]


def test_a_window_without_a_sensor_has_no_label() -> None:
    answer = CLASSIFIER.answer(windows_of(0.0, np.nan))
    assert answer.kind.tolist() == ["current", ""]
    assert CLASSIFIER.labels(answer, 0.5).tolist() == ["ice", ""]
    assert np.isnan(answer.probability[1]).all()


def test_a_log_without_any_of_the_sensors_is_refused() -> None:
    with pytest.raises(ModelError, match="none of the sensors that the classifier was trained with"):
        CLASSIFIER.answer(windows_of(np.nan, np.nan))


@pytest.mark.parametrize("share", [-0.1, 1.0, float("nan")])
def test_a_share_is_from_zero_to_below_one(share: float) -> None:
    with pytest.raises(SettingsError, match="is no share"):
        CLASSIFIER.labels(CLASSIFIER.answer(windows_of(0.0)), share)


def test_what_a_window_has_is_what_the_experts_answered() -> None:
    yes, no = np.zeros((1, 2)), np.full((1, 2), np.nan)
    found = [kinds_of(*pair)[0] for pair in ((yes, yes), (yes, no), (no, yes), (no, no))]
    assert found == ["both", "vibration", "current", ""]

# SPDX-License-Identifier: Apache-2.0
"""A classifier answers with the sensors that a window has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.errors import ModelError, SettingsError
from slipwise.terrain import TerrainClassifier, Windows
from slipwise.terrain.kernel_expert import fit_kernel_expert
from slipwise.terrain.pool import Pool, Rejection, pooled
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
    with pytest.raises(SettingsError, match="is not a share"):
        CLASSIFIER.labels(CLASSIFIER.answer(windows_of(0.0)), share)


def test_the_pool_is_that_of_what_a_window_has() -> None:
    rng = np.random.default_rng(0)
    kernel = fit_kernel_expert(
        rng.standard_normal((20, 6)), np.eye(2)[np.arange(20) % 2], width=0.5, ridge=0.1
    )
    shake = Pool(2.0, 0.0, -1.0, 0.5, 0.3, ())
    both = Pool(1.5, 0.5, -0.5, 0.4, 0.2, ())
    pools = {"current": POOL, "vibration": shake, "both": both}
    made = TerrainClassifier(("ice", "sand"), Cutting(1.0, 4.0, 10.0), kernel, TreeExpert((STUMP,)), pools)
    windows = replace(windows_of(0.0, np.nan, 2.0, np.nan), vibration=rng.standard_normal((4, 6)))
    windows.vibration[[2, 3]] = np.nan
    answer = made.answer(windows)
    assert answer.kind.tolist() == ["both", "vibration", "current", ""]
    vibration, newness = kernel.probabilities(windows.vibration[:2]), kernel.newness(windows.vibration[:2])
    current = TreeExpert((STUMP,)).probabilities(windows.current[:1])
    together = pooled(both, vibration[:1], current)
    np.testing.assert_allclose(answer.probability[:1], together)
    np.testing.assert_allclose(answer.unknown[:1], both.unknown(together, newness[:1]))
    np.testing.assert_allclose(answer.probability[1], pooled(shake, vibration, vibration)[1])

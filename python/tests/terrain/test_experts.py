# SPDX-License-Identifier: Apache-2.0
"""Experts are fitted to what there is, and trees answer as scikit-learn's do."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from sample_terrain import SURFACES, made_recordings

from slipwise.terrain import Windows, cut_windows
from slipwise.terrain.experts import (
    FEATURES_TRIED,
    LEAST_IN_LEAF,
    THINNED,
    TREES,
    MissingLibraryError,
    Shape,
    fit_experts,
)
from slipwise.terrain.windows import cutting_of

SHAPES = (Shape(0.5, 0.1), Shape(0.5, 0.2))


@pytest.fixture(scope="module")
def windows() -> Windows:
    recordings = made_recordings(runs=3, seconds=10.0)
    return cut_windows(recordings, cutting_of(recordings, 2.0), step=0.4)


@pytest.mark.slow
def test_trees_answer_as_those_of_scikit_learn(windows: Windows) -> None:
    ensemble = pytest.importorskip("sklearn.ensemble")
    experts = fit_experts(windows, tuple(SURFACES), SHAPES, 3)
    forest = ensemble.ExtraTreesClassifier(
        TREES,
        max_features=FEATURES_TRIED,
        min_samples_leaf=LEAST_IN_LEAF,
        class_weight="balanced",
        random_state=3,
    )
    forest.fit(windows.current[::THINNED], windows.label[::THINNED].astype(str))
    assert experts.current is not None
    np.testing.assert_allclose(
        experts.current.probabilities(windows.current), forest.predict_proba(windows.current), atol=1e-9
    )


def test_there_is_a_kernel_for_each_shape(windows: Windows) -> None:
    pytest.importorskip("sklearn")
    experts = fit_experts(windows, tuple(SURFACES), SHAPES, 0)
    assert len(experts.vibration) == len(SHAPES)
    assert experts.kinds() == ["vibration", "current", "both"]


def test_without_a_sensor_there_is_no_expert(windows: Windows) -> None:
    pytest.importorskip("sklearn")
    blind = replace(windows, vibration=np.full_like(windows.vibration, np.nan))
    assert fit_experts(blind, tuple(SURFACES), SHAPES, 0).kinds() == ["current"]
    numb = replace(windows, current=np.full_like(windows.current, np.nan))
    assert fit_experts(numb, tuple(SURFACES), SHAPES, 0).kinds() == ["vibration"]


def test_without_scikit_learn_the_extra_is_named(windows: Windows, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.ensemble", None)
    with pytest.raises(MissingLibraryError, match="pip install 'scikit-learn"):
        fit_experts(windows, tuple(SURFACES), SHAPES, 0)

# SPDX-License-Identifier: Apache-2.0
"""Surfaces predict paths: the linear ones exactly, the Gaussian process by a stated projection."""

from pathlib import Path

import numpy as np
import pytest
from known_surface import BASIS, draw

import slipwise as sw
from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis.surfaces import (
    BayesianSurface,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SegmentInfo,
    as_basis_model,
    project_on_basis,
)


@pytest.mark.parametrize("kind", [LeastSquaresSurface, BayesianSurface])
def test_a_linear_surface_is_the_slip_of_its_model_exactly(
    kind: type[LeastSquaresSurface | BayesianSurface], tmp_path: Path
) -> None:
    surface = kind(BASIS)
    surface.fit(draw(200, 1))
    model = as_basis_model(surface, draw(200, 1))
    state = _core.SlipState(1.2, 0.4, 0.0, 0.0)
    slip = _core.slip_rate(model.motion.basis, model.mean, state)
    np.testing.assert_allclose(slip, surface.predict(1.2, 0.4).mean[0], atol=1e-12)
    assert sw.load_model(model.save(tmp_path / "model.yaml")).content == model.content


def test_the_model_predicts_a_held_command_with_the_spread_of_one_segment() -> None:
    examples = draw(2000, 2)
    surface = BayesianSurface(BASIS)
    surface.fit(examples)
    model = as_basis_model(surface, examples, segments=SegmentInfo(seconds=3.0))
    path = sw.predict(model, [[0.0, 1.0, 0.0]], horizon=3.0)
    slip = surface.predict(1.0, 0.0)
    assert path.poses[-1, 0] == pytest.approx(3.0 * (1.0 + slip.mean[0, 0]), rel=2e-3)
    # One segment's slip rate has the noise s, so the end of three seconds has 3 s.
    assert np.sqrt(path.covariance[-1, 2, 2]) == pytest.approx(3.0 * slip.std[0, 2], rel=0.02)


def test_a_gaussian_process_is_projected_and_says_what_the_basis_misses() -> None:
    pytest.importorskip("sklearn", reason="the Gaussian process needs scikit-learn")
    examples = draw(150, 3)
    surface = GaussianProcessSurface()
    surface.fit(examples)
    rich, poor = project_on_basis(surface, BASIS), project_on_basis(surface, _core.named_basis("edd-2"))
    assert (rich.projection_rms < rich.projection_largest).all()
    assert (rich.projection_rms <= poor.projection_rms).all()
    model = as_basis_model(rich, examples)
    assert "misses the surface by" in model.content.verdict.sentence
    at = _core.slip_rate(model.motion.basis, model.mean, _core.SlipState(1.5, 0.5, 0.0, 0.0))
    difference = np.abs(at - surface.predict(1.5, 0.5).mean[0])
    assert (difference <= 1.2 * rich.projection_largest).all()


def test_a_surface_that_is_not_determined_makes_no_model() -> None:
    examples = draw(50, 4)
    surface = LeastSquaresSurface(_core.Basis("twice", ["V", "abs(V)"], ["w"], ["w"]))
    surface.fit(examples)
    with pytest.raises(SettingsError, match="V and abs\\(V\\) cannot be distinguished"):
        as_basis_model(surface, examples)

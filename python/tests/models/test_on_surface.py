# SPDX-License-Identifier: Apache-2.0
"""A model file holds surfaces, and is a model on each of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_models import Made, make_model

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.models import Model, load_model, on_surface
from slipwise.models.on_surface import renamed
from slipwise.models.schema import SurfaceBasis, SurfaceMemorySection, SurfaceSection


def make() -> Model:
    return make_model(Made(_core.named_basis("drive-5"), commands=True))


def memory(size: int, scale: float) -> SurfaceMemorySection:
    basis = SurfaceBasis(
        slip=[0.01] * size,
        covariance=(1e-4 * np.eye(size)).tolist(),
        by_robot=[[0.1]] * size,
        robot=[0.2],
        variance_scale=[scale] * 3,
    )
    return SurfaceMemorySection(
        observed=24, prior_speeds=[1.0, 0.5], weights={"drive-5": 1.0}, bases={"drive-5": basis}
    )


def with_surfaces(*names: str) -> Model:
    model = make()
    size = model.motion.basis.size
    surfaces = [
        SurfaceSection(
            name=name,
            seconds=60.0,
            segments=24,
            visits=2,
            last_seen="2026-01-01",
            speed=1.0,
            yaw_rate=0.5,
            slip=(0.01 * (k + 1) * np.arange(1, size + 1)).tolist(),
            covariance=(1e-4 * (k + 1) * np.eye(size)).tolist(),
            memory=memory(size, 1.0 + k),
        )
        for k, name in enumerate(names)
    ]
    return Model(model.content.model_copy(update={"surfaces": surfaces}))


def test_surfaces_are_read_back(tmp_path: Path) -> None:
    model = with_surfaces("sand", "asphalt")
    assert load_model(model.save(tmp_path / "model.yaml")).content == model.content


def test_a_file_without_surfaces_does_not_mention_them() -> None:
    assert "surfaces" not in make().to_yaml()


def test_the_slip_is_that_of_the_surface_and_the_rest_the_robots() -> None:
    model = with_surfaces("sand", "asphalt")
    on_asphalt = on_surface(model, "asphalt")
    size = model.motion.basis.size
    assert np.allclose(on_asphalt.mean[:size], 0.02 * np.arange(1, size + 1))
    assert np.array_equal(on_asphalt.mean[size:], model.mean[size:])
    assert np.allclose(np.diag(on_asphalt.covariance)[:size], 2e-4)
    assert np.array_equal(on_asphalt.covariance[size:, size:], model.covariance[size:, size:])
    assert on_asphalt.content.noise.variance_scale == [2.0] * 3
    assert on_asphalt.content.weights == {"drive-5": 1.0}


def test_an_unknown_surface_is_refused_with_those_that_are_known() -> None:
    with pytest.raises(ModelError, match="it remembers sand, asphalt"):
        on_surface(with_surfaces("sand", "asphalt"), "ice")
    with pytest.raises(ModelError, match="without a memory"):
        on_surface(make(), "ice")


@pytest.mark.parametrize(
    ("place", "change", "problem"),
    [
        ((), {"slip": [0.1]}, "one per slip parameter|rows"),
        ((), {"covariance": [[1.0]]}, "rows"),
        ((), {"name": ""}, "name"),
        (("memory",), {"weights": {"drive-5": 0.0}}, "not all of them 0"),
        (("memory",), {"weights": {"edd-2": 1.0}}, "a weight for each basis"),
        (("memory",), {"prior_speeds": [0.0, 1.0]}, "prior_speeds"),
        (("memory", "bases", "drive-5"), {"by_robot": [[0.1, 0.2]] * 5}, "rows of 1 numbers"),
        (("memory", "bases", "drive-5"), {"covariance": [[1.0]]}, "rows of 5 numbers"),
    ],
)
def test_a_surface_that_does_not_fit_is_refused(
    place: tuple[str, ...], change: dict[str, object], problem: str
) -> None:
    content = with_surfaces("sand").content.model_dump(mode="json")
    part = content["surfaces"][0]
    for key in place:
        part = part[key]
    part |= change
    with pytest.raises(ValueError, match=problem):
        type(make().content).model_validate(content)


def test_two_surfaces_of_one_name_are_refused() -> None:
    content = with_surfaces("sand", "asphalt").content.model_dump(mode="json")
    content["surfaces"][1]["name"] = "sand"
    with pytest.raises(ValueError, match="one name"):
        type(make().content).model_validate(content)


def test_a_covariance_of_a_basis_that_is_none_is_refused() -> None:
    content = with_surfaces("sand").content.model_dump(mode="json")
    content["surfaces"][0]["memory"]["bases"]["drive-5"]["covariance"] = (-np.eye(5)).tolist()
    with pytest.raises(ModelError, match="not symmetric and positive"):
        Model(type(make().content).model_validate(content))


def test_a_surface_gets_another_name_that_is_free() -> None:
    model = with_surfaces("sand", "asphalt")
    assert [each.name for each in renamed(model, "sand", "beach").content.surfaces] == ["beach", "asphalt"]
    for old, new in (("ice", "beach"), ("sand", "asphalt"), ("sand", " ")):
        with pytest.raises(ModelError, match=r"remembers no surface|taken|not of 1 to 80"):
            renamed(model, old, new)

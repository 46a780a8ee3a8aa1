# SPDX-License-Identifier: Apache-2.0
"""The surfaces of two models of one robot in one."""

from __future__ import annotations

import numpy as np
import pytest
from sample_surfaces import FIRM, LOOSE, model_of_floors

from slipwise.calibration.merge_surfaces import merge_surfaces
from slipwise.errors import ModelError
from slipwise.models import Model

ICE = (-0.02, -0.8)


@pytest.mark.slow
def test_surfaces_that_cannot_be_told_apart_become_one_and_others_keep_their_names() -> None:
    first = model_of_floors(FIRM, LOOSE, labels=("hall", "sand"))
    second = model_of_floors(LOOSE, ICE, seed=10, labels=("beach", "ice"))
    both, done = merge_surfaces(first, second)
    assert [(each.name, each.became, each.merged) for each in done] == [
        ("beach", "sand", True),
        ("ice", "ice", False),
    ]
    names = [each.name for each in both.content.surfaces]
    assert names == ["hall", "sand", "ice"]
    hall, sand, ice = both.content.surfaces
    assert hall == first.content.surfaces[0]
    assert ice == second.content.surfaces[1]
    assert sand.visits == 2
    assert sand.seconds == pytest.approx(
        first.content.surfaces[1].seconds + second.content.surfaces[0].seconds
    )
    assert np.trace(sand.covariance) < np.trace(first.content.surfaces[1].covariance)
    assert len(both.content.provenance.logs) == len(first.content.provenance.logs)
    assert np.array_equal(both.mean, first.mean)


@pytest.mark.slow
def test_other_surfaces_of_a_name_that_is_taken_get_a_number() -> None:
    first, second = model_of_floors(FIRM), model_of_floors(ICE, seed=10)
    both, done = merge_surfaces(first, second)
    assert [each.name for each in both.content.surfaces] == ["surface 1", "surface 1 (2)"]
    assert done[0].became == "surface 1 (2)"


def test_models_of_other_robots_are_refused() -> None:
    model = model_of_floors(FIRM)
    content = model.content
    command = content.model_copy(update={"input": "command"})
    with pytest.raises(ModelError, match="of wheels and the other of commands"):
        merge_surfaces(model, Model(command))
    settings = content.provenance.model_copy(update={"settings": {"vehicle": {"wheel_separation": 2.0}}})
    with pytest.raises(ModelError, match=r"other settings of \[vehicle\]"):
        merge_surfaces(model, Model(content.model_copy(update={"provenance": settings})))
    with pytest.raises(ModelError, match="remembers no surfaces"):
        merge_surfaces(model, Model(content.model_copy(update={"surfaces": []})))

# SPDX-License-Identifier: Apache-2.0
"""Names that surfaces get after they were driven."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.learned_sequence import SurfaceChange
from slipwise.reporting.ground_strip import UNNAMED
from slipwise.reporting.named_surfaces import named_surfaces

ONE = np.ones((4, 1))


def change(what: str, name: str = "", other: str = "", segments: int = 0) -> SurfaceChange:
    return SurfaceChange(what, name, other, 1.0, segments)


def test_a_surface_has_the_name_that_it_gets_when_it_is_left() -> None:
    names, probability = named_surfaces(("",), ONE, [(4, change("new", "sand"))], last="")
    assert names == ("sand",)
    assert (probability == 1.0).all()


def test_the_last_surface_has_the_name_that_the_bank_gives_it() -> None:
    assert named_surfaces(("",), ONE, [], last="ice")[0] == ("ice",)
    assert named_surfaces(("",), ONE, [], last="")[0] == (UNNAMED,)


def test_a_visit_that_is_not_kept_stays_without_a_name() -> None:
    changes = [(3, change("recalled", "sand"))]
    names, probability = named_surfaces(
        ("", "sand"), np.array([[1.0, 0.0]] * 3 + [[0.0, 1.0]]), changes, last="sand"
    )
    assert names == (UNNAMED, "sand")
    assert probability[:, 0].tolist() == [1.0, 1.0, 1.0, 0.0]


def test_windows_that_open_a_surface_are_its_own() -> None:
    changes = [(3, change("new", segments=2)), (4, change("new", "mud"))]
    names, probability = named_surfaces(("",), ONE, changes, last="")
    assert names == (UNNAMED, "mud")
    assert probability[:, 1].tolist() == [0.0, 1.0, 1.0, 1.0]


def test_merged_surfaces_have_one_name_and_the_sum_of_their_probabilities() -> None:
    changes = [(4, change("merged", "a", "b"))]
    names, probability = named_surfaces(("a", "b"), np.full((4, 2), 0.5), changes, last="a")
    assert names == ("a",)
    assert (probability == 1.0).all()

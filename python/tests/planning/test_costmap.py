# SPDX-License-Identifier: Apache-2.0
"""Maps that rollouts can sample: any real cells, and words for what is none."""

import math

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.planning.costmap import Costmap


def test_the_core_reads_a_map_once() -> None:
    map_ = Costmap([[1, 2, 3], [4, 5, 6]], 0.5)
    assert map_.in_core is map_.in_core


def test_cells_that_are_no_rows_and_columns_are_refused(subtests: pytest.Subtests) -> None:
    for cells in [[], [[]], [1.0, 2.0], 3.0, np.zeros((2, 2, 2))]:
        with subtests.test(cells=cells), pytest.raises(SettingsError, match="give rows and columns"):
            _ = Costmap(cells, 0.5).in_core  # type: ignore[arg-type]


@pytest.mark.parametrize("resolution", [0.0, -0.1, math.nan, math.inf])
def test_a_resolution_that_is_no_positive_number_is_refused(resolution: float) -> None:
    with pytest.raises(SettingsError, match="resolution"):
        _ = Costmap(np.zeros((2, 2)), resolution).in_core


def test_an_origin_that_is_not_finite_is_refused() -> None:
    with pytest.raises(SettingsError, match="origin is not finite"):
        _ = Costmap(np.zeros((2, 2)), 0.5, origin=(0.0, math.nan)).in_core

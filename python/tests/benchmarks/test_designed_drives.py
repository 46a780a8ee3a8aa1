# SPDX-License-Identifier: Apache-2.0
"""Designed drives teach what was asked of them: more than twice what uniform random commands do."""

from __future__ import annotations

import pytest
from designed_drives import design_table


@pytest.mark.slow
@pytest.mark.parametrize("prior", ["each term", "fraction"])
def test_worst_yaw_is_sure_after_five_and_ten_moves(prior: str) -> None:
    table = design_table()
    designed, uniform = table[f"designed, {prior}"], table[f"uniform, {prior}"]
    assert designed[5][0] <= 0.035
    assert designed[10][0] <= 0.022
    assert designed[10][0] <= 0.5 * uniform[10][0]

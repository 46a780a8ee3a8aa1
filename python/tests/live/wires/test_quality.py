# SPDX-License-Identifier: Apache-2.0
"""A subscription asks for no more than every publisher offers."""

from __future__ import annotations

import pytest

from slipwise.live.wires.quality import Quality, hearing_all

BEST_EFFORT = Quality(reliable=False, latched=False)
USUAL = Quality(reliable=True, latched=False)
LATCHED = Quality(reliable=True, latched=True)


@pytest.mark.parametrize(
    ("offered", "latched", "asked"),
    [
        ([], False, USUAL),
        ([], True, LATCHED),
        ([LATCHED], False, USUAL),
        ([LATCHED], True, LATCHED),
        ([USUAL, LATCHED], True, USUAL),
        ([USUAL, BEST_EFFORT], False, BEST_EFFORT),
        ([BEST_EFFORT], True, BEST_EFFORT),
    ],
)
def test_the_weakest_publisher_decides(offered: list[Quality], latched: bool, asked: Quality) -> None:
    assert hearing_all(offered, latched=latched) == asked

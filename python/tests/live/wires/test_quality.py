# SPDX-License-Identifier: Apache-2.0
"""A subscription asks for no more than every publisher offers."""

from __future__ import annotations

import pytest

from slipwise.live.wires.wire import Quality, hearing_all

BEST_EFFORT = Quality(reliable=False, latched=False)
USUAL = Quality(reliable=True, latched=False)
LATCHED = Quality(reliable=True, latched=True)


def test_the_weakest_publisher_decides(subtests: pytest.Subtests) -> None:
    for offered, latched, asked in [
        ([], False, USUAL),
        ([], True, LATCHED),
        ([LATCHED], False, USUAL),
        ([LATCHED], True, LATCHED),
        ([USUAL, LATCHED], True, USUAL),
        ([USUAL, BEST_EFFORT], False, BEST_EFFORT),
        ([BEST_EFFORT], True, BEST_EFFORT),
    ]:
        with subtests.test(offered=offered, latched=latched, asked=asked):
            assert hearing_all(offered, latched=latched) == asked

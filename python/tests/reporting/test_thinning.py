# SPDX-License-Identifier: Apache-2.0
"""Thinning of long curves."""

from __future__ import annotations

from slipwise.reporting.figure import thinned, thinning_note


def test_long_curve_keeps_its_ends_and_says_so() -> None:
    kept = thinned(100_000, 2000)
    assert (kept[0], kept[-1], len(kept)) == (0, 99_999, 2000)
    assert thinning_note(100_000, 2000).startswith("Drawn thinned: 2000 evenly spaced of 100000 points")

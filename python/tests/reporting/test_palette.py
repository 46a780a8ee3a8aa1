# SPDX-License-Identifier: Apache-2.0
"""Colours and lines of the methods."""

from __future__ import annotations

from slipwise.reporting.palette import stroke_of

METHODS = ("none", "vendor", "edd-2", "drive-5", "ipem-9", "odd-even-10", "batch", "auto")


def test_methods_differ_in_colour() -> None:
    colours = [stroke_of(name, METHODS).colour for name in METHODS]
    assert len(set(colours)) == len(METHODS)


def test_main_methods_keep_their_colour_whatever_is_compared() -> None:
    assert stroke_of("auto", ("auto",)) == stroke_of("auto", METHODS)

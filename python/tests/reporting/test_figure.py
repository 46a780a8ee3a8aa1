# SPDX-License-Identifier: Apache-2.0
"""A figure as data."""

from __future__ import annotations

import json

import numpy as np

from slipwise.reporting.figure import Figure, axis, baseline_label, numbers


def test_numbers_keep_six_digits_and_drop_what_is_not_finite() -> None:
    assert numbers([1.23456789, np.nan, np.inf, 2.0]) == [1.23457, None, None, 2]
    assert numbers([[1e-12, 1.5]]) == [[1e-12, 1.5]]


def test_figure_data_cannot_end_the_script_that_holds_it() -> None:
    figure = Figure(key="a", label="</script>", traces=[{"name": "</script><script>alert(1)//"}])
    assert "</script>" not in figure.json()
    assert json.loads(figure.json())["data"][0]["name"] == "</script><script>alert(1)//"
    assert figure.html().count("</script>") == 1


def test_layout_is_added_to_the_standard_one() -> None:
    layout = json.loads(Figure(key="a", label="a", traces=[], layout={"margin": {"t": 40}}).json())["layout"]
    assert layout["margin"] == {"l": 50, "r": 12, "t": 40, "b": 38}


def test_label_from_a_user_holds_no_markup_and_no_format() -> None:
    assert baseline_label("<b>&%{x}$") == "&lt;b&gt;&amp;% {x}＄"


def test_axis_keeps_the_options_it_is_given() -> None:
    assert axis("time [s]", type="log")["type"] == "log"
    assert axis("time [s]")["title"]["text"] == "time [s]"

# SPDX-License-Identifier: Apache-2.0
"""A figure as data."""

from __future__ import annotations

import json

from slipwise.reporting.figure import Figure, baseline_label


def test_figure_data_cannot_end_the_script_that_holds_it() -> None:
    figure = Figure(key="a", label="</script>", traces=[{"name": "</script><script>alert(1)//"}])
    assert "</script>" not in figure.json()
    assert json.loads(figure.json())["data"][0]["name"] == "</script><script>alert(1)//"
    assert figure.html().count("</script>") == 1


def test_label_from_a_user_holds_no_markup_and_no_format() -> None:
    assert baseline_label("<b>&%{x}$") == "&lt;b&gt;&amp;% {x}＄"

# SPDX-License-Identifier: Apache-2.0
"""A figure says what it shows, or what is missing; panels and tables are consistent."""

from __future__ import annotations

import numpy as np
import pytest
from toy_chapters import FLAT, TABLE, toy_results

from slipwise_thesis import Grid, Heat, Line, Panel, ThesisFigure, outline, paths_line


def test_a_figure_without_words_or_parts_is_refused() -> None:
    with pytest.raises(ValueError, match="agrees, differs"):
        ThesisFigure("figure-1", "Figure 1", "Title", "shows", " ", "", "source", (FLAT,))
    with pytest.raises(ValueError, match="parts"):
        ThesisFigure("figure-1", "Figure 1", "Title", "shows", "agrees", "differs", "source")


def test_parts_are_separated_in_their_order() -> None:
    figure = toy_results()[0].figures[0]
    assert [panel.title for panel in figure.panels] == ["Lines", "Bars", "Correlation"]
    assert figure.grids == (TABLE,)


def test_a_missing_log_leaves_a_sentence_that_says_which_and_how_to_give_it() -> None:
    missing = toy_results()[0].figures[2]
    assert missing.parts == ()
    assert "nobody/has_this" in missing.missing
    assert "SLIPWISE_DATA or --data" in missing.missing


def test_a_table_with_a_row_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="2 cells"):
        Grid("t", ("a", "b"), (("1",),))


def test_series_without_a_colour_take_the_next_one_and_heat_takes_none() -> None:
    x = np.zeros(1)
    one, own, two = Line(x, x), Line(x, x, colour="#123456"), Line(x, x)
    heat = Heat(np.eye(1), ("a",), ("a",))
    colours = [colour for _, colour in Panel("", "", "", (one, own, two)).coloured()]
    assert colours[1] == "#123456"
    assert len(set(colours)) == 3
    assert Panel("", "", "", (heat,)).solid is False


def test_paths_are_one_line_with_gaps() -> None:
    line = paths_line([np.zeros((2, 3)), np.ones((3, 3))])
    assert np.flatnonzero(np.isnan(line.x)).tolist() == [2, 6]
    assert np.nanmax(line.y) == 1.0


def test_an_outline_is_one_standard_deviation_away() -> None:
    line = outline(np.array([1.0, 2.0]), np.diag([4.0, 9.0]))
    assert np.max(line.x) == pytest.approx(3.0)
    assert np.max(line.y) == pytest.approx(5.0)
    with pytest.raises(ValueError, match="no covariance"):
        outline(np.zeros(2), np.diag([-1.0, 1.0]))

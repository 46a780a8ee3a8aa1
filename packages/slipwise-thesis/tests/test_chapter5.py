# SPDX-License-Identifier: Apache-2.0
"""Chapter 5 on small drives: surfaces, their scores and costs; and segments that tell little."""

from __future__ import annotations

import logging
import re
from pathlib import Path

import numpy as np
import pytest
from steady_paths import drawn_group

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis import SMALL, Fixture, Points, Surface, ThesisFigure
from slipwise_thesis.chapter5 import chapter5_figures
from slipwise_thesis.chapter5_examples import examples_of, husky_examples
from slipwise_thesis.surfaces import (
    BayesianSurface,
    GaussianProcessSurface,
    LeastSquaresSurface,
    as_basis_model,
)

pytestmark = pytest.mark.slow

pytest.importorskip("mujoco")
pytest.importorskip("sklearn")

Figures = dict[str, ThesisFigure]
THESIS = _core.named_basis("thesis-15")


@pytest.fixture(scope="module")
def figures() -> Figures:
    reported: list[float] = []
    made = chapter5_figures(Fixture(size=SMALL), lambda _what, fraction: reported.append(fraction))
    assert reported == sorted(reported)
    assert all(0.0 <= fraction < 1.0 for fraction in reported)
    return {figure.key: figure for figure in made}


def test_every_figure_and_table_is_there_with_finite_numbers(figures: Figures) -> None:
    assert {"figure-5-1", "figure-5-2", "figure-5-3", "table-5-scores", "table-5-times"} <= set(figures)
    for figure in figures.values():
        text = f"{figure.shows} {figure.agrees} {figure.differs}"
        assert not re.search(r"\bnan\b|\binf\b|–", text), figure.key


def test_surfaces_have_a_finite_mean_a_positive_spread_and_their_examples(figures: Figures) -> None:
    for key in ("figure-5-1", "figure-5-2", "figure-5-3"):
        assert len(figures[key].panels) == 3
        assert "is missing" in figures[key].source
        for panel in figures[key].panels:
            surface = next(series for series in panel.series if isinstance(series, Surface))
            points = next(series for series in panel.series if isinstance(series, Points))
            assert np.isfinite(surface.z).all()
            assert surface.std is not None
            assert (surface.std > 0.0).all()
            assert points.z is not None
            assert np.ptp(points.z) > 0.0


def test_every_surface_beats_no_slip_on_commands_it_has_not_learned(figures: Figures) -> None:
    for grid in figures["table-5-scores"].grids:
        baseline, *surfaces = [float(row[grid.columns.index("angular [mrad/s]")]) for row in grid.rows]
        assert len(surfaces) == 6
        assert max(surfaces) < baseline / 3.0


def test_a_process_that_is_too_large_to_time_is_called_an_estimate(figures: Figures) -> None:
    (grid,) = figures["table-5-times"].grids
    process = next(row for row in grid.rows if row[0] == "Gaussian process")
    assert [cell.startswith("about") for cell in process[1:]] == [False, True, True] * 2
    assert not any("about" in cell for row in grid.rows for cell in row if row is not process)


def test_a_real_husky_loses_half_of_its_turn_on_tile(real_log_dir: Path) -> None:
    examples = husky_examples(Fixture(data=real_log_dir))
    assert len(examples.learned) + len(examples.held_out) == len(examples.whole) == 200
    surface = LeastSquaresSurface(_core.named_basis("odd-even-10"))
    surface.fit(examples.learned)
    at = surface.predict([0.0], [1.0]).mean[0]
    assert -0.65 < at[2] < -0.4


def test_segments_of_one_speed_name_what_they_do_not_tell_and_make_no_model() -> None:
    turns = (-0.3, -0.1, 0.1, 0.2, 0.4)
    groups = [drawn_group(seed=k, count=8, command=(0.5, turn)) for k, turn in enumerate(turns)]
    examples = examples_of("drawn", [path for group in groups for path in group.paths]).whole
    surface = LeastSquaresSurface(THESIS)
    surface.fit(examples)
    assert len(surface.notes) == 6
    assert all("V" in note for note in surface.notes)
    with pytest.raises(SettingsError, match=r"do not determine the surface .*V.*drive at more speeds"):
        as_basis_model(surface, examples)
    other = BayesianSurface(THESIS)
    other.fit(examples)
    assert all(note.endswith("but by the prior") for note in other.notes)
    assert np.isfinite(other.predict([1.5], [0.1]).std).all()


def test_segments_that_repeat_are_counted_aloud_and_learned(caplog: pytest.LogCaptureFixture) -> None:
    paths = drawn_group(seed=1, count=6).paths
    with caplog.at_level(logging.WARNING):
        examples = examples_of("drawn", [*paths, *paths]).whole
    assert "6 of 12 examples repeat earlier ones" in caplog.text
    surface = GaussianProcessSurface()
    surface.fit(examples)
    assert np.isfinite(surface.predict([0.5], [0.25]).std).all()


def test_twenty_thousand_segments_are_too_many_for_a_gaussian_process() -> None:
    examples = examples_of("drawn", drawn_group(seed=1, count=10).paths).whole
    many = examples[np.arange(20_000) % 10]
    with pytest.raises(SettingsError, match=r"20000 examples are too many .*bayesian surface, or thin=True"):
        GaussianProcessSurface().fit(many)

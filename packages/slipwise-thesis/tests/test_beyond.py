# SPDX-License-Identifier: Apache-2.0
"""Figures beyond the thesis: no method without its baselines, and covariances held against the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

import slipwise as sw
from slipwise import _core
from slipwise_thesis import SMALL, Fixture, ThesisFigure
from slipwise_thesis.consistency import consistency_figures
from slipwise_thesis.monte_carlo import ESTIMATORS, Feeding, judged, known_run, learned, nees_band
from slipwise_thesis.real_log_scores import METHODS, mean_ratios, warthog_names
from slipwise_thesis.real_logs import SHORT, real_log_figures

pytestmark = pytest.mark.slow

SLIP = _core.named_basis("full-linear-6")


def quiet(_what: str, fraction: float) -> None:
    assert 0.0 <= fraction < 1.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with short simulated logs in the places of the Husky's and the Warthog's."""
    data = tmp_path_factory.mktemp("data")
    for seed, name in enumerate(("husky/tile_deflated_tyres", "warthog/grass", "warthog_windows/sand")):
        drive = Drive(seconds=40.0, seed=seed, basis=SLIP, alpha=(-0.1, 0.0, 0.0, 0.05, 0.0, -0.3), lag=0.2)
        (data / name).parent.mkdir(exist_ok=True)
        sw.save_log(simulated_log(drive), data / f"{name}.csv")
    return data


@pytest.fixture(scope="module")
def figures(folder: Path) -> dict[str, ThesisFigure]:
    pytest.importorskip("sklearn", reason="the Gaussian process needs scikit-learn")
    return {figure.key: figure for figure in real_log_figures(Fixture(data=folder), quiet)}


def test_every_method_stands_beside_its_baselines(figures: dict[str, ThesisFigure]) -> None:
    (wheel, command) = figures["real-log-husky"].grids
    shown = [row[0].removesuffix(" (not causal)") for row in wheel.rows]
    assert shown == [SHORT[method] for method in METHODS]
    assert {row[0] for row in wheel.rows} - {row[0] for row in command.rows} == {"slip-ratio-ekf"}
    assert "batch (not causal)" in {row[0] for row in wheel.rows}
    means, *logs = figures["real-logs-warthog"].grids
    assert [row[0] for row in means.rows] == [SHORT[method] for method in METHODS]
    assert [[row[0] for row in grid.rows] for grid in logs] == [["warthog/grass", "warthog_windows/sand"]] * 2
    assert float(means.rows[0][1]) == 1.0


def test_sentences_hold_the_numbers_of_the_tables(figures: dict[str, ThesisFigure]) -> None:
    figure = figures["real-logs-warthog"]
    means = figure.grids[0]
    ratios = {row[0]: row[1] for row in means.rows}
    surfaces = ", ".join(ratios[name] for name in ("least-squares", "gaussian-process", "bayesian"))
    assert f"from the wheel input, the surfaces leave {surfaces}" in figure.agrees
    causal = {name: float(number) for name, number in ratios.items() if name not in ("none", "batch")}
    best = min(causal.values())
    assert any(f"{name} leaves least" in figure.differs for name, value in causal.items() if value == best)


def test_without_logs_each_figure_says_which_and_how_to_give_them(tmp_path: Path) -> None:
    for fixture in (Fixture(), Fixture(data=tmp_path)):
        husky, warthog = real_log_figures(fixture, quiet)
        assert "husky/tile_deflated_tyres is missing" in husky.missing
        assert "the Warthog's logs are missing" in warthog.missing


def test_all_warthog_logs_of_the_folder_are_taken(folder: Path) -> None:
    assert warthog_names(Fixture(data=folder)) == ["warthog/grass", "warthog_windows/sand"]


def test_a_mean_over_no_log_is_none() -> None:
    assert mean_ratios([], "auto") is None


def test_the_consistency_table_has_every_estimator_and_places_it() -> None:
    (figure,) = consistency_figures(Fixture(size=SMALL), quiet)
    (table,) = figure.grids
    assert [row[0] for row in table.rows] == 2 * [feeding.label for feeding in ESTIMATORS]
    low, high = nees_band(SMALL.seeds, 10)
    for row in table.rows:
        mean = float(row[2])
        assert row[4] == ("below" if mean < low else "above" if mean > high else "inside")
    places = {row[0]: row[4] for row in table.rows if row[1] == "slip and pose noise"}
    assert places["ekf-thesis, 20 Hz, (6.7)"] == "above"
    assert places["gradient-descent, 20 Hz"] == "below"
    assert "ekf-thesis, 20 Hz, (6.7)" in figure.differs


def test_true_parameters_have_no_error_and_the_prior_is_its_own_measure() -> None:
    drive = known_run("odd-even-10", 4, minutes=0.5)
    right = judged(_core.Estimate(drive.truth, drive.prior.covariance), drive)
    assert (right.nees, right.error, right.in_region_90) == (0.0, 0.0, True)
    untaught = judged(drive.prior, drive)
    assert untaught.error == pytest.approx(np.sqrt(untaught.nees))


@pytest.mark.parametrize("name", ["iekf", "delayed-state", "batch"])
def test_an_estimator_that_counts_data_once_is_consistent_over_thirty_drives(name: str) -> None:
    results = []
    for seed in range(30):
        drive = known_run("odd-even-10", seed, minutes=1.0)
        results.append(judged(learned(Feeding(name), drive), drive))
    low, high = nees_band(len(results), 10)
    assert low < np.mean([result.nees for result in results]) < high
    assert np.mean([result.error for result in results]) < 0.7

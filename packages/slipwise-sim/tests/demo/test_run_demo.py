# SPDX-License-Identifier: Apache-2.0
"""The demonstration shows slipwise ahead of doing nothing and of a vendor's multiplier."""

from __future__ import annotations

from pathlib import Path

import pytest

from slipwise import load_model, open_log
from slipwise_sim.demo import DemoOptions, DemoResult, run_demo

pytestmark = pytest.mark.slow

pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def commanded() -> list[tuple[str, float]]:
    return []


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory, commanded: list[tuple[str, float]]) -> DemoResult:
    folder = tmp_path_factory.mktemp("demo")
    return run_demo(folder, DemoOptions(duration=120.0), progress=lambda *now: commanded.append(now))


def test_slipwise_beats_doing_nothing_and_the_vendor(result: DemoResult) -> None:
    for horizon in (2.0, 5.0):
        learned = result.evaluation.score("auto", horizon)
        assert learned.position_ratio[2] < 0.5
        assert learned.heading_ratio[2] < 0.5
        vendor = result.evaluation.score("vendor", horizon)
        assert learned.position.mean < 0.5 * vendor.position.mean
    assert result.calibration.verdict.good


def test_the_files_are_what_the_result_says(result: DemoResult) -> None:
    assert {path.name for path in result.bag.parent.iterdir()} == {"drive.mcap", "model.yaml", "report.html"}
    assert load_model(result.model).content == result.calibration.model.content
    assert len(open_log(result.bag).runs[0].poses) == len(result.log.runs[0].poses)
    assert "simulated 1000 kg" in result.report.read_text()


def test_progress_only_grows_and_reaches_the_end(
    result: DemoResult, commanded: list[tuple[str, float]]
) -> None:
    fractions = [fraction for _, fraction in commanded]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_the_same_seed_gives_the_same_bag_and_scores(result: DemoResult, tmp_path: Path) -> None:
    again = run_demo(tmp_path, DemoOptions(duration=120.0))
    assert again.bag.read_bytes() == result.bag.read_bytes()
    assert again.evaluation.scores == result.evaluation.scores

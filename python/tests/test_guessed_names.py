# SPDX-License-Identifier: Apache-2.0
"""What people guess works, or says what does."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log
from sample_models import make_model, named

import slipwise as sw
from slipwise.cli.main import run
from slipwise.logs import LogOptions
from slipwise.planning import Controller, ReferencePath, learned_motions, rollout, trajectory_to

MODEL = make_model(named("edd-2"))
COMMANDS = [(0.0, 1.0, 0.3), (2.0, 1.0, -0.3)]


@pytest.fixture(scope="module")
def tidy_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "drive.csv"
    sw.save_log(simulated_log(Drive(seconds=10.0, seed=1)), path)
    return path


@pytest.mark.parametrize(
    ("owner", "name", "hint"),
    [
        (sw, "load", "load_model"),
        (sw, "fit", "calibrate"),
        (sw, "Controller", "slipwise.planning.Controller"),
        (MODEL, "predict", "slipwise.predict(model"),
        (MODEL, "params", "model.parameters"),
    ],
)
def test_guess_is_answered_with_what_works(owner: object, name: str, hint: str) -> None:
    with pytest.raises(AttributeError, match="has no attribute") as problem:
        getattr(owner, name)
    assert hint in str(problem.value)


def test_path_has_its_columns_its_end_and_a_length() -> None:
    path = sw.predict(MODEL, COMMANDS, horizon=5.0)
    assert len(path) == len(path.t) == len(path.x)
    np.testing.assert_array_equal(np.column_stack((path.x, path.y, path.yaw)), path.poses)
    np.testing.assert_array_equal(path.end, path.poses[-1])


def test_model_tells_its_verdict() -> None:
    assert MODEL.verdict.good is MODEL.content.verdict.good
    assert str(MODEL.verdict).startswith(MODEL.verdict.sentence)


def test_open_log_takes_single_options(tidy_log: Path) -> None:
    whole, late = sw.open_log(tidy_log), sw.open_log(tidy_log, start=2.0)
    assert late.runs[0].span[0] > whole.runs[0].span[0]
    named = sw.open_log(tidy_log, options=LogOptions(start=2.0))
    np.testing.assert_array_equal(late.runs[0].poses.t, named.runs[0].poses.t)
    with pytest.raises(sw.SlipwiseError, match="no such option: begin"):
        sw.open_log(tidy_log, begin=2.0)


def test_log_is_a_data_frame_with_the_columns_of_a_tidy_table(tidy_log: Path) -> None:
    pytest.importorskip("pandas")
    log = sw.open_log(tidy_log)
    frame = log.to_dataframe()
    assert {"run", "t", "cmd_v", "cmd_omega", "x", "y", "yaw"} <= set(frame.columns)
    assert frame["x"].notna().sum() == sum(len(run.poses) for run in log.runs)


def test_controller_takes_a_model_and_says_what_a_path_is() -> None:
    path = ReferencePath(np.array([[0.0, 0.0], [20.0, 0.0]]), speed=0.8)
    first, second = Controller(MODEL, path), Controller(learned_motions(MODEL), path)
    pose, drive = (0.0, 0.1, 0.0), (0.5, 0.0)
    assert first.command(pose, drive) == second.command(pose, drive)
    with pytest.raises(sw.SlipwiseError, match="ReferencePath"):
        Controller(MODEL, [(0.0, 0.0), (1.0, 0.0)])  # type: ignore[arg-type]


def test_speeds_far_beyond_the_log_warn_at_the_line_of_the_caller() -> None:
    most = max(map(abs, MODEL.content.range.speed))
    with pytest.warns(UserWarning, match="far beyond") as caught:
        sw.predict(MODEL, [(0.0, 3.0 * most, 0.0)], horizon=1.0)
    with pytest.warns(UserWarning, match="far beyond") as second:
        rollout(MODEL, np.full((2, 3, 2), [-3.0 * most, 0.0]), 0.1)
    assert [Path(warning.filename).name for warning in (*caught, *second)] == [Path(__file__).name] * 2
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sw.predict(MODEL, [(0.0, 1.5 * most, 0.0)], horizon=1.0)


def test_results_of_planning_have_short_reprs() -> None:
    path = trajectory_to(MODEL, (2.0, 0.5, 0.0))
    for shown in (path, rollout(MODEL, np.zeros((2, 3, 2)), 0.1), *learned_motions(MODEL)):
        assert len(repr(shown)) < 120
        assert repr(shown).startswith(f"<{type(shown).__name__}")


def test_inspect_of_a_model_says_what_shows_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = MODEL.save(tmp_path / "model.yaml")
    assert run(["inspect", str(file)]) == 2
    text = " ".join(capsys.readouterr().err.split())
    assert "a model, not a log" in text
    assert "slipwise show" in text


def test_a_log_in_place_of_a_model_says_what_learns_one() -> None:
    with pytest.raises(
        sw.SlipwiseError, match=r"a log, not a model \(run.mcap\): `slipwise calibrate run.mc"
    ):
        sw.load_model("run.mcap")

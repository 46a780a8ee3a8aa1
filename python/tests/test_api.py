# SPDX-License-Identifier: Apache-2.0
"""What `import slipwise` offers: paths are taken; results are short, pickled, drawn and made data frames."""

from __future__ import annotations

import copy
import inspect
import pickle
import sys
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log
from sample_models import LIMITS, make_model, named

import slipwise as sw
from slipwise import _core, calibration
from slipwise import evaluation as evaluation_of
from slipwise.errors import ModelError
from slipwise.models import ModelFile

COMMANDS = [(0.0, 1.0, 0.3), (2.0, 1.0, -0.3)]
OPTIONS = sw.EvaluationOptions((2.0,), ("none", "edd-2"))


@pytest.fixture(scope="module")
def log() -> sw.Log:
    return simulated_log(Drive(seconds=40.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.4)))


@pytest.fixture(scope="module")
def result(log: sw.Log) -> sw.Calibration:
    return sw.calibrate(log, basis="edd-2", input="wheel", smooth=True)


@pytest.fixture(scope="module")
def evaluation(log: sw.Log) -> sw.Evaluation:
    return sw.evaluate(log, input="wheel", options=OPTIONS)


@pytest.fixture(scope="module")
def path(result: sw.Calibration) -> sw.Path:
    return sw.predict(result.model, COMMANDS, horizon=3.0)


def test_dir_shows_the_api_and_nothing_else() -> None:
    shown = dir(sw)
    assert set(shown) == {*sw.__all__, "__version__"}
    assert all(getattr(sw, name) is not None for name in shown)


@pytest.mark.parametrize(
    "call",
    [sw.calibrate, sw.evaluate, calibration.calibrate, evaluation_of.evaluate],
    ids=["sw.calibrate", "sw.evaluate", "calibrate", "evaluate"],
)
def test_the_input_has_one_name_everywhere(call: Callable[..., object]) -> None:
    names = [name for name in inspect.signature(call).parameters if name.startswith("input")]
    assert names == ["input"]
    assert "input" in ModelFile.model_fields
    assert "input" in sw.Evaluation.__dataclass_fields__


def test_paths_stand_for_logs_and_models(tmp_path: Path, log: sw.Log, result: sw.Calibration) -> None:
    table = tmp_path / "run.csv"
    sw.save_log(log, table)
    file = result.model.save(tmp_path / "model.yaml")
    for given in (str(table), table, [table]):
        assert sw.calibrate(given, basis="edd-2", input="wheel").verdict.good
    judged = sw.evaluate(table, model=str(file), options=sw.EvaluationOptions((2.0,), ("none", "model")))
    assert judged.score("model", 2.0).position_ratio[0] < 0.5
    from_file = sw.predict(file, COMMANDS, horizon=3.0)
    np.testing.assert_array_equal(from_file.poses, sw.predict(result.model, COMMANDS, horizon=3.0).poses)


def test_results_are_short_to_look_at(
    log: sw.Log, result: sw.Calibration, evaluation: sw.Evaluation, path: sw.Path
) -> None:
    run = log.runs[0]
    shown = [log, run, run.commands, run.poses, result, result.model, result.history, result.smoothed]
    shown += [evaluation, evaluation.scores[0], evaluation.predictions[0], path, sw.Settings()]
    for each in shown:
        assert len(repr(each)) < 300
        assert "\n" not in repr(each)
        assert "array" not in repr(each)
    assert repr(log) == "<Log: 1 run, 40 s; commands, wheel speeds, 800 poses>"
    assert repr(sw.Settings()) == "Settings()"
    assert repr(sw.make_settings({"basis": "edd-2", "segment": {"length": 2.0}})) == (
        "Settings(basis='edd-2', segment={'length': 2.0})"
    )
    assert "of what its wheels say" in repr(result.model)
    assert repr(path).startswith("<Path of 31 poses over 3.00 s to x ")


def test_notebooks_show_the_summary_and_escape_what_a_file_says(result: sw.Calibration) -> None:
    html = result._repr_html_()
    assert sw.summarise(result.model).sentences[0] in html
    hostile = make_model(replace(named("edd-2"), sentence="<script>alert(1)</script>"))
    assert "<script>" not in hostile._repr_html_()


def test_scores_are_a_table_in_a_notebook(evaluation: sw.Evaluation) -> None:
    html = evaluation._repr_html_()
    assert html.count("<tr>") == 1 + len(evaluation.scores)


def test_a_parameter_is_found_by_its_physical_name() -> None:
    model = make_model(replace(named("edd-2"), commands=True, limits=LIMITS))
    assert model["delay_v"].value == pytest.approx(0.2)
    assert model["delay_v"].std == pytest.approx(0.002)
    assert model["delay_v"].unit == "s"
    assert model["limits.speed.saturation"].value == 1.1
    assert "delay_v" in model
    assert "log_delay_v" not in model
    assert list(model)[:2] == ["lon.V", "ang.w"]
    with pytest.raises(
        ModelError, match=r"no parameter 'log_delay_v': it has lon\.V, ang\.w, time_constant_v"
    ):
        model["log_delay_v"]


def test_models_and_results_are_pickled(
    log: sw.Log, result: sw.Calibration, evaluation: sw.Evaluation, path: sw.Path
) -> None:
    assert result.model.motion is not None  # what the core has made is not pickled, but made again
    again = pickle.loads(pickle.dumps(result))  # noqa: S301
    assert again.model == result.model
    assert again.model.motion.parameters[0].name == "lon.V"
    np.testing.assert_array_equal(
        sw.predict(again.model, COMMANDS, horizon=3.0).poses, path.poses, strict=True
    )
    for each in (log, evaluation, path, sw.Settings(), result.history):
        assert repr(pickle.loads(pickle.dumps(each))) == repr(each)  # noqa: S301
    assert copy.deepcopy(result.model) == result.model


def test_a_result_writes_its_report(tmp_path: Path, result: sw.Calibration) -> None:
    written = result.report(tmp_path / "x.html")
    assert written == tmp_path / "x.html"
    assert escape(result.verdict.sentence) in written.read_text(encoding="utf-8")


def test_a_path_is_drawn_with_its_ellipses(path: sw.Path) -> None:
    figure = path.plot()
    assert figure.layout.yaxis.scaleanchor == "x"
    assert "sendChartToCloud" in figure.layout.modebar.remove
    np.testing.assert_array_equal(figure.data[0].x, path.poses[:, 0])
    assert 2 <= len(figure.data) <= 7
    last = np.array([figure.data[-1].x, figure.data[-1].y])
    np.testing.assert_allclose(last[:, :-1].mean(axis=1), path.poses[-1, :2], atol=1e-6)


def test_results_are_data_frames(
    tmp_path: Path, result: sw.Calibration, evaluation: sw.Evaluation, path: sw.Path
) -> None:
    pytest.importorskip("pandas")
    frame = path.to_dataframe()
    assert list(frame.columns[:4]) == ["t", "x", "y", "yaw"]
    assert frame["cov_xt"].iloc[-1] == path.covariance[-1, 0, 2]
    parameters = result.to_dataframe().set_index("name")
    assert parameters.loc["ang.w", "value"] == result.model["ang.w"].value
    assert result.history is not None
    history = result.history.to_dataframe()
    assert len(history) == len(result.history.t)
    assert history["std(ang.w)"].iloc[-1] == result.history.std[-1, 1]
    assert result.smoothed is not None
    smoothed = result.smoothed.to_dataframe()
    lines = result.smoothed.save(tmp_path / "smoothed.csv").read_text().splitlines()
    assert lines[0].split(",") == list(smoothed.columns)
    scores = evaluation.to_dataframe()
    assert list(scores["method"]) == ["none", "edd-2"]
    assert scores["position_ratio_high"].iloc[1] == evaluation.score("edd-2", 2.0).position_ratio[2]
    assert scores["coverage_95"].iloc[1] == evaluation.score("edd-2", 2.0).coverage[2]


def test_without_pandas_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch, path: sw.Path) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(sw.SlipwiseError, match=r"needs pandas, .*: pip install 'pandas"):
        path.to_dataframe()

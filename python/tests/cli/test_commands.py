# SPDX-License-Identifier: Apache-2.0
"""What the commands print and write when all is well, and the exit code of a verdict."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Columns, Result, left_in, make_columns, write_csv
from sample_logs import Drive

from slipwise import load_model, load_settings

Slipwise = Callable[..., Result]

COMMANDS = (
    *("demo", "inspect", "calibrate", "evaluate", "show", "compare", "export"),
    *("plan", "lattice", "simulate", "convert", "reproduce"),
)


@pytest.fixture
def dull_csv(folder: Path) -> Path:
    """A robot that does exactly what it is commanded, so that there is nothing to learn."""
    drive = Drive(seconds=60.0, slip_psd=(0.0, 0.0, 0.0), pose_std=(0.0, 0.0))
    return write_csv(folder / "dull.csv", make_columns(drive))


def test_help_has_examples(slipwise: Slipwise, subtests: pytest.Subtests) -> None:
    for command in COMMANDS:
        with subtests.test(command=command):
            result = slipwise(command, "--help")
            assert (result.code, result.err) == (0, "")
            assert f"\n    slipwise {command} " in result.out


def test_no_arguments_show_the_commands(slipwise: Slipwise) -> None:
    result = slipwise()
    assert result.code == 0
    for command in COMMANDS:
        assert f"\n  {command} " in result.out


def test_calibrate_writes_model_settings_result_and_report(slipwise: Slipwise, drive_csv: Path) -> None:
    result = slipwise("calibrate", drive_csv, "-o", "model.yaml", "--basis", "edd-2")
    assert (result.code, result.err) == (0, "")
    latest = Path("runs/latest")
    assert {path.name for path in latest.iterdir()} == {
        "model.yaml",
        "settings.toml",
        "result.json",
        "report.html",
    }
    assert Path("model.yaml").read_bytes() == (latest / "model.yaml").read_bytes()
    values = {p.name: p for p in load_model("model.yaml").content.parameters}
    assert abs(values["ang.w"].value + 0.3) < 4.0 * values["ang.w"].std
    assert "ang.w" in result.out
    assert "The model misses by " in result.out


def test_calibrate_says_what_was_learned_then_the_verdict_then_the_numbers(
    slipwise: Slipwise, drive_csv: Path
) -> None:
    out = slipwise("calibrate", drive_csv, "-o", "model.yaml", "--basis", "edd-2", "--no-report").out
    said = (
        "% of what is commanded.",
        "times better than the kinematic baseline.",
        "GOOD. ",
        "slipwise evaluate OTHER_LOG --model model.yaml",
        "Nothing was left out.",
        "Parameters",
        "identified",
    )
    places = [out.rindex(text) for text in said]
    assert places == sorted(places)
    assert "log_" not in out
    sentences = json.loads(Path("runs/latest/result.json").read_text())["summary"]
    assert all(sentence in out for sentence in sentences)


def test_the_settings_of_a_run_give_the_same_model_again(slipwise: Slipwise, drive_csv: Path) -> None:
    Path("mine.toml").write_text("basis = 'drive-5'\n[prior]\nslip_fraction = 0.2\n")
    slipwise("calibrate", drive_csv, "--settings", "mine.toml", "--no-report", "-o", "first.yaml")
    settings = Path("runs/latest/settings.toml")
    assert load_settings(settings) == load_settings(Path("mine.toml"))
    assert tomllib.loads(settings.read_text())["prior"]["slip_fraction"] == 0.2
    slipwise("calibrate", drive_csv, "--settings", settings, "--no-report", "-o", "second.yaml")
    assert Path("first.yaml").read_bytes() == Path("second.yaml").read_bytes()


@pytest.mark.parametrize("estimator", ["ekf-thesis"])
def test_calibrate_learns_by_the_estimator_that_is_named(
    slipwise: Slipwise, drive_csv: Path, estimator: str
) -> None:
    asked = ("--set", f"estimator={estimator}", "--basis", "edd-2", "--input", "wheel")
    result = slipwise("calibrate", drive_csv, *asked, "-o", "model.yaml")
    assert (result.code, result.err) == (0, "")
    assert load_model("model.yaml").content.provenance.settings["estimator"] == estimator
    assert estimator in Path("runs/latest/report.html").read_text(encoding="utf-8")
    settings = Path("runs/latest/settings.toml")
    slipwise(
        "calibrate", drive_csv, "--settings", settings, "--input", "wheel", "--no-report", "-o", "again.yaml"
    )
    assert Path("again.yaml").read_bytes() == Path("model.yaml").read_bytes()


def test_smoothed_parameters_are_written_and_shown_where_asked_for(
    slipwise: Slipwise, drive_csv: Path
) -> None:
    result = slipwise(
        "calibrate", drive_csv, "--basis", "edd-2", "--set", "smoothing.smooth=true", "--json", "-"
    )
    table = Path(result.json["files"]["smoothed"])
    assert table == Path("runs") / Path(result.json["files"]["settings"]).parent.name / "smoothed.csv"
    assert table.read_text().startswith("run,t_start,t_end,lon.V,std(lon.V),ang.w,")
    assert "figure-smoothed-1" in Path("runs/latest/report.html").read_text(encoding="utf-8")


def test_json_on_stdout_is_all_that_is_printed(slipwise: Slipwise, drive_csv: Path) -> None:
    result = slipwise("calibrate", drive_csv, "--basis", "edd-2", "--no-report", "--json", "-")
    assert result.err == ""
    assert result.json["verdict"]["good"] is True
    assert result.json["exit_code"] == result.code == 0
    assert json.loads(Path("runs/latest/result.json").read_text()) == result.json


def test_a_model_that_does_not_beat_the_plain_one_is_written_and_exits_with_1(
    slipwise: Slipwise, dull_csv: Path
) -> None:
    result = slipwise("calibrate", dull_csv, "-o", "model.yaml", "--no-report", "--input", "wheel")
    assert result.code == 1
    assert "NOT GOOD ENOUGH" in result.out
    assert load_model("model.yaml").content.verdict.good is False


def test_evaluate_exits_with_1_where_learning_does_not_help(slipwise: Slipwise, dull_csv: Path) -> None:
    result = slipwise("evaluate", dull_csv, "--input", "wheel", "--methods", "auto")
    assert result.code == 1
    assert "NOT GOOD ENOUGH" in result.out


def test_evaluate_shows_every_method_at_every_horizon(slipwise: Slipwise, drive_csv: Path) -> None:
    arguments = (
        "--methods",
        "vendor,edd-2,batch,auto",
        "--vendor-wheel-separation-multiplier",
        "1.4",
        "--horizons",
        "1,2",
    )
    result = slipwise("evaluate", drive_csv, *arguments, "--json", "scores.json")
    assert (result.code, result.err) == (0, "")
    for head in ("After 1 s, from commands", "After 2 s, from commands", "too optimistic", "batch †"):
        assert head in result.out
    document = json.loads(Path("scores.json").read_text())
    found = {(score["method"], score["horizon"]) for score in document["scores"]}
    assert found == {(m, h) for m in ("none", "vendor", "edd-2", "batch", "auto") for h in (1.0, 2.0)}


def test_predictions_report_and_json_go_where_they_are_asked_to(slipwise: Slipwise, drive_csv: Path) -> None:
    files = {"--predictions": "p.csv", "--report": "r.html", "--json": "s.json"}
    result = slipwise(
        "evaluate", drive_csv, "--methods", "auto", *(x for pair in files.items() for x in pair)
    )
    assert result.code == 0
    assert Path("p.csv").read_text().count("\n") > 100
    assert "<html" in Path("r.html").read_text()[:200]
    assert json.loads(Path("s.json").read_text())["command"] == "evaluate"


def test_simulate_is_reproducible(slipwise: Slipwise, folder: Path) -> None:
    pytest.importorskip("mujoco")
    for name in ("a.csv", "b.csv"):
        assert slipwise("simulate", "-o", name, "--duration", "3", "--seed", "5").code == 0
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()
    assert left_in(folder) == {"a.csv", "b.csv"}


def test_inspect_says_what_is_in_a_log(slipwise: Slipwise, drive_csv: Path) -> None:
    result = slipwise("inspect", drive_csv)
    assert (result.code, result.err) == (0, "")
    for part in ("poses", "rate [Hz]", "clock_offset", "omega [rad/s]", "V [m/s]", "identifiable: "):
        assert part in result.out


def test_inspect_is_content_with_nothing_to_learn(slipwise: Slipwise, folder: Path, columns: Columns) -> None:
    write_csv(folder / "ten.csv", {name: values[:10] for name, values in columns.items()})
    result = slipwise("inspect", "ten.csv")
    assert (result.code, result.err) == (0, "")
    assert "From commands nothing can be learned: the log has no window to learn from" in result.out


def test_the_process_prints_what_the_call_prints(
    process: Slipwise, slipwise: Slipwise, drive_csv: Path
) -> None:
    assert process("inspect", drive_csv).out == slipwise("inspect", drive_csv).out

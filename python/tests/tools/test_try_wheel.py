# SPDX-License-Identifier: Apache-2.0
"""A wheel that is missing or does not install is an error; the log it is tried with can be learned from."""

import tomllib
from pathlib import Path

import pytest
from tools.requirements import ROOT
from tools.try_wheel import main, said, the_wheel, write_log

import slipwise as sw


def test_a_folder_without_one_wheel_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(tmp_path) == 1
    assert "holds 0 wheels" in capsys.readouterr().err
    wheels = [tmp_path / f"slipwise-0.2.{patch}-py3-none-any.whl" for patch in (0, 1)]
    wheels[0].touch()
    assert the_wheel(tmp_path) == wheels[0]
    wheels[1].touch()
    with pytest.raises(ValueError, match="holds 2 wheels"):
        the_wheel(tmp_path)


def test_what_a_failing_command_says_is_in_the_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="returned 3:\nwhy"):
        said(["sh", "-c", "echo why; exit 3"], tmp_path)


def test_commands_know_no_other_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", "elsewhere")
    assert said(["sh", "-c", 'echo "[$PYTHONPATH]"'], tmp_path) == "[]\n"


def test_the_log_that_a_wheel_is_tried_with_can_be_learned_from(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    write_log(path)
    result = sw.calibrate(path, basis="edd-2")
    assert result.verdict.good
    assert result.model["ang.w"].value == pytest.approx(-0.2, abs=0.03)


def test_nothing_is_compiled_for_the_processor_of_the_machine_that_builds() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    build = [str(project["tool"]["scikit-build"]), str(project["tool"]["cibuildwheel"])]
    files = ("CMakeLists.txt", "CMakePresets.json", "Makefile")
    for text in [*build, *((ROOT / name).read_text(encoding="utf-8") for name in files)]:
        assert "-march" not in text

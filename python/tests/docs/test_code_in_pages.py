# SPDX-License-Identifier: Apache-2.0
"""Code in the documents runs, on a small simulated log, and the commands in them exist."""

import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest
import typer
from python.tests.docs.pages import PAGES, ROOT, blocks, name_of
from typer.core import TyperGroup
from warm_process import run_forked

import slipwise as sw
from slipwise.calibration.calibrate_sequence import calibrate_sequence
from slipwise.calibration.learned_sequence import SequenceOptions
from slipwise.cli.main import app, with_ports

WITH_PYTHON = [page for page in PAGES if blocks(page, "python")]
COMMAND = re.compile(r"^(?:\.venv/bin/)?slipwise .*")


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with what the pages take for granted: a short bag, its model, one with a surface."""
    pytest.importorskip("mujoco", reason="the log is simulated, which needs MuJoCo")
    from slipwise_sim import Scenario, simulate

    folder = tmp_path_factory.mktemp("drive")
    log = simulate(Scenario(duration=90.0), seed=2).log
    sw.save_log(log, folder / "run.mcap")
    sw.calibrate(log, basis="edd-2").model.save(folder / "model.yaml")
    learned, _ = calibrate_sequence([log], options=SequenceOptions(labels=("sand",)))
    learned.model.save(folder / "tuesday.yaml")
    return folder


@pytest.mark.parametrize("page", WITH_PYTHON, ids=name_of)
def test_python_of_a_page_runs(page: Path, drive: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(drive)
    for number, block in enumerate(blocks(page, "python"), start=1):
        exec(compile(block, f"{page.name}, block {number}", "exec"), {})


def test_the_readme_learns_a_model_that_is_good_and_predicts_five_seconds(
    drive: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(drive)
    names: dict[str, object] = {}
    block, _ = blocks(ROOT / "README.md", "python")
    exec(block, names)
    result, path = names["result"], names["path"]
    assert isinstance(result, sw.Calibration)
    assert isinstance(path, sw.Path)
    assert result.verdict.good
    assert str(result.verdict) in capsys.readouterr().out
    assert path.t[-1] - path.t[0] == 5.0
    assert sw.load_model("model.yaml").content == result.model.content


def command_lines() -> list[tuple[str, str]]:
    """Return every slipwise command line in the pages, with the page's name."""
    found = []
    for page in PAGES:
        for block in blocks(page, "sh"):
            found += [(name_of(page), line) for line in block.splitlines() if COMMAND.match(line)]
    return found


def test_a_command_line_is_understood(subtests: pytest.Subtests) -> None:
    whole: Any = typer.main.get_command(app)
    for page, line in command_lines():
        with subtests.test(page=page, line=line):
            command = whole
            words = with_ports(shlex.split(line, comments=True)[1:])
            while isinstance(command, TyperGroup):  # `slipwise terrain train` is a command of a command
                assert words[0] in command.commands, f"{page}: no command {words[0]}"
                command, words = command.commands[words[0]], words[1:]
            context = command.make_context(command.name, words)
            assert context.params


@pytest.mark.slow
def test_the_command_lines_of_the_readme_run(drive: Path, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    for name in ("run.mcap", "other.mcap", "logs/husky-1.mcap", "logs/husky-2.mcap"):
        shutil.copy(drive / "run.mcap", tmp_path / name)
    for name in ("model.yaml", "old.yaml", "new.yaml"):
        shutil.copy(drive / "model.yaml", tmp_path / name)
    failed = []
    lines = [line for page, line in command_lines() if page == "README.md" and "--pose-topic" not in line]
    assert len(lines) >= 9  # the one with --pose-topic wants a robot: the tests of the wires have one
    for line in lines:
        words = shlex.split(line, comments=True)[1:]
        done = run_forked(words, tmp_path, seconds=300, environment={"ROS_DISTRO": "jazzy"})
        if done.code:
            failed.append(f"{line}: {done.code}\n{done.out[-500:]}{done.err[-500:]}")
    assert not failed, "\n".join(failed)


def test_make_targets_in_the_pages_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    used = set()
    for page in PAGES:
        for block in blocks(page, "sh"):
            used |= set(re.findall(r"^make ([a-z-]+)", block, re.MULTILINE))
    assert used
    assert used <= targets


def test_the_figure_of_the_readme_is_small_and_drawn_by_a_script() -> None:
    figure = ROOT / "docs/figures/prediction.png"
    assert 10_000 < figure.stat().st_size < 150_000
    assert figure.name in (ROOT / "docs/figures/make_figures.py").read_text(encoding="utf-8")

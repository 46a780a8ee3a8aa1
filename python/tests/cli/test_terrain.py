# SPDX-License-Identifier: Apache-2.0
"""`slipwise terrain`: from tables with labels to a classifier, and from it to labels."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import shutil
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_terrain import made_recordings, write_tables

from slipwise.cli.main import run

pytestmark = pytest.mark.skipif(find_spec("sklearn") is None, reason="training needs scikit-learn")

pytestmark = pytest.mark.slow

Slipwise = Callable[..., Result]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder with tables and a classifier of them, and what training printed."""
    folder = tmp_path_factory.mktemp("terrain")
    tables = write_tables(folder, made_recordings(runs=3, seconds=10.0))
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        code = run(
            ["terrain", "train", *map(str, tables), "--window", "2", "-o", str(folder / "terrain.json")]
        )
    assert code == 0
    return folder, text.getvalue()


@pytest.fixture
def files(made: tuple[Path, str], folder: Path) -> Path:
    """The working folder, with a copy of these files."""
    return Path(shutil.copytree(made[0], folder, dirs_exist_ok=True))


def test_training_says_how_good_it_is_on_runs_left_out(made: tuple[Path, str], files: Path) -> None:
    assert "grass: 3 runs, gravel: 3 runs, tiles: 3 runs" in made[1]
    assert "Windows of 2 s in runs left out of learning" in made[1]
    assert "Calling unknown surfaces unknown" in made[1]
    content = json.loads(Path("terrain.json").read_text())
    assert content["surfaces"] == ["grass", "gravel", "tiles"]
    assert content["training"]["scores"]["both"]["accuracy"] > 0.95


@pytest.mark.usefixtures("files")
def test_new_drives_are_labelled_and_compared_with_their_own_names(slipwise: Slipwise, folder: Path) -> None:
    (folder / "new").mkdir()
    tables = write_tables(folder / "new", made_recordings(runs=1, seed=1))
    result = slipwise("terrain", "classify", "terrain.json", *tables, "-o", "out.csv", "--unknown", 0)
    assert result.code == 0, result.err
    assert (
        "the most probable surface is right in 1.000 of 30 windows with IMU and motor currents" in result.out
    )
    with Path("out.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [
        "run",
        "t_start",
        "t_end",
        "label",
        "p_grass",
        "p_gravel",
        "p_tiles",
        "p_unknown",
    ]
    assert [row["label"] for row in rows] == [row["run"].split("_")[0] for row in rows]
    assert {float(row["t_end"]) - float(row["t_start"]) for row in rows} == {2.0}


@pytest.mark.usefixtures("files")
def test_json_has_the_figures(slipwise: Slipwise) -> None:
    result = slipwise("terrain", "classify", "terrain.json", "imu.csv", "--step", 1, "--json", "-")
    assert result.code == 0, result.err
    assert result.json["command"] == "terrain classify"
    assert sum(result.json["labels"].values()) == result.json["windows"] == 81
    assert "score" not in result.json  # the IMU's table names no surface


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("classify terrain.json imu.csv -o imu.csv", "this would replace what is read"),
        ("classify terrain.json imu.csv -o terrain.json", "this would replace what is read"),
        ("classify terrain.json imu.csv -o x --json x", "two results would be one file"),
        ("classify imu.csv imu.csv", "not a terrain classifier"),
        ("classify terrain.json none.csv", "no such file"),
        ("classify terrain.json imu.csv --unknown 1", "1 is not a share"),
        ("classify terrain.json imu.csv --step 0", "a step of 0 s"),
        ("train imu.csv", "0 surfaces with 2 runs or more; two are needed"),
        ("train imu.csv currents.csv --window 9", "windows of 9 s"),
        ("train imu.csv -o currents.csv/x", "cannot write"),
        ("train currents.csv -o currents.csv", "this would replace what is read"),
        ("train currents.csv -o x --json x", "two results would be one file"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line(slipwise: Slipwise, line: str, message: str) -> None:
    before = {path: path.read_bytes() for path in Path().iterdir() if path.is_file()}
    result = slipwise("terrain", *line.split())
    assert (result.code, result.out) == (2, "")
    assert result.line.startswith(message)
    assert {path: path.read_bytes() for path in Path().iterdir() if path.is_file()} == before


def test_help_shows_examples(slipwise: Slipwise) -> None:
    for command in ("", "train", "classify"):
        result = slipwise("terrain", *command.split(), "--help")
        assert result.code == 0
        assert "Examples:\n" in result.out

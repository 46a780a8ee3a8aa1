# SPDX-License-Identifier: Apache-2.0
"""No command replaces what it reads, by whatever name, nor writes two results into one file."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Result, left_in
from sample_models import make_model, named

from slipwise.cli.main import app
from slipwise.cli.writable import refuse_unwritable
from slipwise.errors import OutputError
from slipwise.planning.pgm import write_pgm

Slipwise = Callable[..., Result]

#: Paths that commands take: what they read, and what they write. `runs` is a folder that gets new folders.
READ = {
    "merge",
    "classifier",
    "logs",
    "replay",
    "poses",
    "settings",
    "model",
    "first",
    "second",
    "map_file",
    "data",
    "prior",
}
WRITTEN = {"output", "report", "json", "predictions", "runs", "record", "results", "cache", "excite"}


def by_symlink(path: Path) -> Path:
    Path("symlink").symlink_to(path.absolute())
    return Path("symlink")


def by_hardlink(path: Path) -> Path:
    Path("hardlink").hardlink_to(path)
    return Path("hardlink")


def by_another_way(path: Path) -> Path:
    Path("sub").mkdir()
    return Path("sub") / ".." / path.name


def test_an_output_that_is_an_input_is_refused(folder: Path, subtests: pytest.Subtests) -> None:
    for name in [Path, Path.absolute, by_symlink, by_hardlink, by_another_way]:
        with subtests.test(name=name):
            source = Path("drive.csv")
            source.touch()
            refuse_unwritable(Path("other.csv"), inputs=[source])
            with pytest.raises(
                OutputError, match=r"this would replace what is read \(.*\): name another file"
            ):
                refuse_unwritable(name(source), inputs=[source])


def test_a_file_of_a_bag_folder_is_an_input(folder: Path) -> None:
    Path("bag").mkdir()
    Path("bag/bag_0.db3").touch()
    refuse_unwritable(Path("bag/report.html"), inputs=[Path("bag")])
    with pytest.raises(OutputError, match=r"would replace what is read \(bag/bag_0.db3, a part of bag\)"):
        refuse_unwritable(Path("bag/bag_0.db3"), inputs=[Path("bag")])


def test_a_dash_is_no_name_of_a_file(folder: Path) -> None:
    with pytest.raises(OutputError, match=r"not a file \(-\): name a file, or use `--json -` to print"):
        refuse_unwritable(Path("-"))
    assert not left_in(folder)


@pytest.mark.parametrize("second", ["a.json", "./a.json", "link.json"])
def test_two_outputs_of_one_name_are_refused_before_they_are_there(folder: Path, second: str) -> None:
    Path("link.json").symlink_to("a.json")
    refuse_unwritable(Path("a.json"), Path("b.json"))
    with pytest.raises(OutputError, match=r"two results would be one file \(.*\): name two files"):
        refuse_unwritable(Path("a.json"), Path(second))
    assert left_in(folder) == {"link.json"}


@pytest.fixture
def files(folder: Path, drive_csv: Path) -> None:
    """One of each file that commands read."""
    make_model(named("edd-2", ang__w=-0.3)).save(folder / "m.yaml")
    make_model(named("edd-2", ang__w=-0.4)).save(folder / "other.yaml")
    (folder / "p.csv").write_text("t,x,y,yaw\n")
    (folder / "s.toml").write_text("basis = 'edd-2'\n")
    (folder / "v.yaml").write_text("vehicle: {wheelbase: 1.0}\n")
    write_pgm(folder / "map.png", np.ones((60, 60)))  # what a file is called says nothing of what it is
    (folder / "map.yaml").write_text("image: map.png\nresolution: 0.1\norigin: [-3.0, -3.0, 0.0]\n")


ROUTE = ("--from=-1,-1,0", "--to", "1,1,0")
DESTROYING = (
    "terrain train drive.csv -o drive.csv",
    "terrain train drive.csv -o new.json --json drive.csv",
    "terrain classify m.yaml drive.csv -o drive.csv",
    "terrain classify m.yaml drive.csv -o m.yaml",
    "terrain classify m.yaml drive.csv -o new.csv --json m.yaml",
    "calibrate drive.csv -o drive.csv",
    "calibrate drive.csv --report drive.csv",
    "calibrate drive.csv --json drive.csv",
    "calibrate drive.csv --prior m.yaml -o m.yaml",
    "calibrate drive.csv --settings s.toml -o s.toml",
    "evaluate drive.csv --predictions drive.csv",
    "evaluate drive.csv --report drive.csv",
    "evaluate drive.csv --json drive.csv",
    "evaluate drive.csv --model m.yaml --report m.yaml",
    "evaluate drive.csv --settings s.toml --json s.toml",
    "live --replay drive.csv -o drive.csv",
    "live --replay drive.csv --results drive.csv",
    "live --replay drive.csv --model m.yaml -o m.yaml",
    "live --replay drive.csv --memory --model m.yaml -o m.yaml",
    "live --replay drive.csv --settings s.toml -o s.toml",
    "excite --area 8x8 --vehicle husky --model m.yaml --json m.yaml",
    "fleet drive.csv --settings s.toml --json s.toml",
    "inspect drive.csv --json drive.csv",
    "doctor drive.csv --json drive.csv",
    "inspect drive.csv --settings s.toml --json s.toml",
    "inspect drive.csv --excite drive.csv",
    "convert drive.csv -o drive.csv",
    "convert drive.csv -o new.csv --json drive.csv",
    "export m.yaml --to amcl -o m.yaml",
    "export m.yaml --to all -o config --json m.yaml",
    "lattice m.yaml --json m.yaml",
    "show m.yaml --json m.yaml",
    "score p.csv drive.csv --json p.csv",
    "score p.csv drive.csv --json drive.csv",
    "convert drive.csv -o drive.parquet --card --json drive.csv",
    "evaluate drive.csv --poses p.csv --json p.csv",
    "calibrate drive.csv --vehicle v.yaml -o v.yaml",
    "compare m.yaml other.yaml --json other.yaml",
    "compare m.yaml other.yaml drive.csv --json drive.csv",
    "surfaces list m.yaml --json m.yaml",
    "surfaces rename m.yaml a b -o m.yaml",
    "surfaces merge m.yaml other.yaml -o other.yaml",
    "plan --model m.yaml --map map.yaml --json m.yaml",
    "plan --model m.yaml --map map.yaml --json map.yaml",
)
TWICE = (
    "terrain train drive.csv -o x --json x",
    "terrain classify m.yaml drive.csv -o x --json x",
    "calibrate drive.csv -o x --report x",
    "calibrate drive.csv -o x --json x",
    "evaluate drive.csv --predictions x --report x",
    "convert drive.csv -o x.csv --json x.csv",
    "inspect drive.csv --excite x --json x",
    "convert drive.csv -o x.parquet --card --json x.card.yaml",
    "simulate -o x.csv --json x.csv",
    "export m.yaml --to amcl -o x --json x",
    "lattice m.yaml -o x --json x/lattice.json",
    "plan --model m.yaml --map map.yaml -o x --json x.html",
    "demo -o x --json x/result.json",
    "reproduce thesis -o x --json x/index.html",
)


@pytest.mark.usefixtures("files")
def test_every_command_refuses_and_leaves_everything_as_it_was(
    slipwise: Slipwise, subtests: pytest.Subtests
) -> None:
    before = {path: path.read_bytes() for path in Path().iterdir()}
    for line in (*DESTROYING, *TWICE):
        with subtests.test(line=line):
            arguments = [*line.split(), *(ROUTE if line.startswith("plan") else ())]
            result = slipwise(*arguments)
            assert (result.code, result.out) == (2, "")
            expected = "two results would be one file" if line in TWICE else "this would replace what is read"
            assert result.line.startswith(expected)
            assert {path: path.read_bytes() for path in Path().iterdir()} == before


def test_every_path_that_a_command_takes_is_known_here() -> None:
    """A new option for a file must be named above, and in a line that says what it must not destroy."""
    commands = [("", command) for command in app.registered_commands]
    for group in app.registered_groups:
        assert group.typer_instance is not None
        commands += [(f"{group.name} ", command) for command in group.typer_instance.registered_commands]
    for before, command in commands:
        assert command.callback is not None
        name = before + (command.name or command.callback.__name__)
        signature = inspect.signature(command.callback, eval_str=True)
        paths = {name for name, parameter in signature.parameters.items() if "Path" in str(parameter)}
        assert paths <= READ | WRITTEN, name
        assert any(line.startswith(f"{name} ") for line in (*DESTROYING, *TWICE)), name


def test_calibrate_writes_through_a_link_and_keeps_the_mode(slipwise: Slipwise, drive_csv: Path) -> None:
    real = drive_csv.parent / "store" / "model.yaml"
    real.parent.mkdir()
    real.write_text("old")
    real.chmod(0o600)
    Path("model.yaml").symlink_to(real)
    assert slipwise("calibrate", drive_csv, "--basis", "edd-2", "--no-report", "-o", "model.yaml").code == 0
    assert Path("model.yaml").is_symlink()
    assert real.stat().st_mode & 0o777 == 0o600
    assert real.read_text().startswith("# slipwise motion model")

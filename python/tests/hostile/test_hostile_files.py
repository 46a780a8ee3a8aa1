# SPDX-License-Identifier: Apache-2.0
"""Files that once crashed slipwise or took all memory: each command ends with an answer or one plain line."""

from __future__ import annotations

import gzip
import os
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from cli.conftest import Columns, Result, left_in, write_csv
from sample_models import make_model, named
from warm_process import run_forked

from slipwise.logs.unpacking import _zstd

MEMORY = 2 << 30  # bytes of address space
SECONDS = 60
MAP = "image: {image}\nresolution: 0.25\norigin: [-5.0, -5.0, 0.0]\nnegate: 0\nfree_thresh: 0.196\n"
ENDINGS = (".csv", ".mcap", ".db3", ".bag", ".parquet")


def bounded(folder: Path, *arguments: object, seconds: int = SECONDS) -> Result:
    """Run a command within 2 GiB and a minute; nothing but an answer or one plain line may come of it."""
    before = left_in(folder)
    done = run_forked(arguments, folder, seconds=seconds, memory=MEMORY)
    result = Result(done.code, done.out, done.err)
    assert result.code in (0, 1, 2), result
    assert "Traceback" not in result.out + result.err
    assert "fault of slipwise" not in result.err
    if result.code == 2:
        assert result.line
        assert left_in(folder) == before
    else:
        assert result.err == ""
    return result


@pytest.mark.slow
def test_a_bag_that_unpacks_to_gigabytes_is_refused(folder: Path) -> None:
    packer = _zstd().ZstdCompressor()
    packed = b"".join(packer.compress(bytes(1 << 24)) for _ in range(512)) + packer.flush()
    chunk = struct.pack("<QQQI", 0, 1, 512 << 24, 0) + struct.pack("<I", 4) + b"zstd"
    records = (
        (1, struct.pack("<I", 4) + b"ros2" + struct.pack("<I", 0)),
        (6, chunk + struct.pack("<Q", len(packed)) + packed),
    )
    content = b"".join(struct.pack("<BQ", kind, len(data)) + data for kind, data in records)
    (folder / "bomb.mcap").write_bytes(b"\x89MCAP0\r\n" + content)
    assert len(packed) < 1_000_000
    assert "a chunk of the bag unpacks to more than 512 MiB" in bounded(folder, "inspect", "bomb.mcap").line


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_table_that_unpacks_to_gigabytes_is_refused(folder: Path, kind: str) -> None:
    if kind == "csv":
        with gzip.open(folder / "bomb.csv", "wb", compresslevel=9) as file:
            file.write(b"t,cmd_v,cmd_omega,x,y,yaw\n")
            for _ in range(128):
                file.write(b"0,0,0,0,0,0\n" * 700_000)
    else:
        zeros = pa.array(np.zeros(15_000_000))
        table = pa.table(dict.fromkeys(("t", "x", "y", "yaw", "cmd_v", "cmd_omega"), zeros))
        pq.write_table(table, folder / "bomb.csv", compression="zstd")
    assert "the table unpacks to more than 512 MiB" in bounded(folder, "inspect", "bomb.csv").line


@pytest.mark.slow
@pytest.mark.parametrize("name", ["log.csv", "log.mcap", "model.yaml", "map.yaml", "settings.toml"])
def test_a_pipe_that_nobody_writes_to_is_refused(folder: Path, drive_csv: Path, name: str) -> None:
    model = folder / "sound.yaml"
    make_model(named("edd-2")).save(model)
    os.mkfifo(folder / name)
    route = ("--from=0,0,0", "--to", "1,0,0")
    commands: dict[str, tuple[object, ...]] = {
        "log.csv": ("inspect", name),
        "log.mcap": ("calibrate", name),
        "model.yaml": ("export", name, "--to", "all", "-o", "out"),
        "map.yaml": ("plan", "--model", model, "--map", name, *route),
        "settings.toml": ("calibrate", drive_csv, "--settings", name),
    }
    assert "not a regular file" in bounded(folder, *commands[name]).line


@pytest.mark.parametrize(
    ("image", "expected"),
    [("/dev/zero", "not a regular file (/dev/zero)"), ('"a\\0b.pgm"', "not the name of a file")],
)
def test_a_map_without_an_image_is_refused(folder: Path, image: str, expected: str) -> None:
    model = folder / "sound.yaml"
    make_model(named("edd-2")).save(model)
    (folder / "map.yaml").write_text(MAP.format(image=image))
    arguments = ("--model", model, "--map", "map.yaml", "--from=0,0,0", "--to", "1,0,0")
    assert expected in bounded(folder, "plan", *arguments).line


@pytest.mark.parametrize(
    ("factor", "offset", "expected"),
    [
        (1e9, 1.7e18, "look like nanoseconds"),
        (1e3, 1.7e12, "look like milliseconds"),
        (0.0, 2.0**63, "no time in any unit"),
        (0.0, -(2.0**63), "no time in any unit"),
    ],
)
@pytest.mark.parametrize("command", ["calibrate", "convert"])
def test_stamps_in_another_unit_are_named_by_every_verb(
    slipwise: Callable[..., Result],
    columns: Columns,
    folder: Path,
    command: str,
    factor: float,
    offset: float,
    expected: str,
) -> None:
    columns["t"] = columns["t"] * factor + offset
    write_csv(folder / "drive.csv", columns)
    result = slipwise(command, "drive.csv", "-o", "out.mcap" if command == "convert" else "out.yaml")
    assert result.code == 2
    assert expected in result.line
    assert not list(folder.glob("out*"))


def fitting(path: Path, shared: Path) -> tuple[object, ...]:
    """Return the command that such a file is given to."""
    if path.name.startswith("map"):
        route = ("--from=0,0,0", "--to", "2,0,0", "--radius", "0.2")
        return ("plan", "--model", shared / "m_wheel.yaml", "--map", path, *route)
    if path.name.startswith(("model", "m_")):
        return ("export", path, "--to", "all", "-o", "out")
    if path.name.startswith("settings"):
        return ("calibrate", shared / "base.csv", "--settings", path, "--no-report")
    return ("calibrate", path, "--no-report", "-o", "model.yaml")


def hostile_files(kinds: tuple[str, ...] = (*ENDINGS, ".yaml", ".toml")) -> list[Path]:
    """Return the files of the folder `hostile` beside the real logs, where there is one."""
    data = os.environ.get("SLIPWISE_DATA", "")
    shared = Path(data).parent / "hostile"
    if not data or not shared.is_dir():
        return []
    return sorted(path for path in shared.rglob("*") if path.suffix in kinds)


@pytest.mark.slow
@pytest.mark.parametrize("path", hostile_files(), ids=lambda path: path.name)
def test_every_hostile_file_gives_an_answer_or_one_line(folder: Path, path: Path) -> None:
    shared = path.parent if path.parent.name == "hostile" else path.parent.parent
    result = bounded(folder, *fitting(path, shared), seconds=10 * SECONDS)  # ten: the machine may be busy
    if "spike" in path.name or path.name.startswith("csvcal"):
        assert result.code in (0, 1)
        assert "far beyond all speeds before" in result.out


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", [p for p in hostile_files() if p.suffix in ENDINGS], ids=lambda path: path.name
)
def test_every_hostile_log_is_converted_or_refused(folder: Path, path: Path) -> None:
    bounded(folder, "convert", path, "-o", "out.mcap", seconds=10 * SECONDS)

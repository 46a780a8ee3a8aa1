# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with the input is said in one line with exit code 2, or left out and counted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli.conftest import Columns, Result, left_in, write_csv

Slipwise = Callable[..., Result]
BASIS = ("--basis", "edd-2")  # what is left out does not depend on it


def counts(slipwise: Slipwise, path: Path) -> dict[str, int]:
    """Calibrate from a damaged log that is still good for learning; return what was left out, by kind."""
    result = slipwise("calibrate", path, *BASIS, "--no-report", "--json", "-")
    assert result.code == 0, result
    assert result.err == ""
    found: dict[str, int] = {}
    for entry in result.json["left_out"]:
        assert entry["where"]
        found[entry["kind"]] = found.get(entry["kind"], 0) + entry["count"]
    return found


def refusal(slipwise: Slipwise, folder: Path, *arguments: object) -> str:
    """Return the one line of a command that fails with 2 and leaves nothing behind."""
    before = left_in(folder)
    result = slipwise(*arguments)
    assert result.code == 2, result
    assert result.out == ""
    assert left_in(folder) == before
    return result.line


def test_an_empty_file_is_refused(slipwise: Slipwise, folder: Path, subtests: pytest.Subtests) -> None:
    for name in ["drive.csv", "drive.csv.gz", "drive.parquet", "drive.mcap", "drive.bag"]:
        with subtests.test(name=name):
            (folder / name).touch()
            assert refusal(slipwise, folder, "calibrate", name).startswith(f"the file is empty ({name})")


@pytest.mark.parametrize("name", ["drive.mcap", "drive.db3", "drive.bag", "drive.parquet"])
def test_wrong_magic_bytes_are_refused(slipwise: Slipwise, folder: Path, name: str) -> None:
    (folder / name).write_bytes(b"neither bag nor table" * 50)
    assert f"wrong magic bytes ({name})" in refusal(slipwise, folder, "calibrate", name)


def test_a_missing_file_is_named(slipwise: Slipwise, folder: Path) -> None:
    assert refusal(slipwise, folder, "calibrate", "no.csv") == "no such file (no.csv): check the path"


def test_a_truncated_bag_is_used_as_far_as_it_goes_and_counted(slipwise: Slipwise, drive_csv: Path) -> None:
    assert slipwise("convert", drive_csv, "-o", "drive.mcap").code == 0
    content = Path("drive.mcap").read_bytes()
    Path("cut.mcap").write_bytes(content[: 7 * len(content) // 10])
    assert counts(slipwise, Path("cut.mcap"))["damaged-bag"] > 0


def test_a_bag_truncated_to_its_first_bytes_is_refused(slipwise: Slipwise, drive_csv: Path) -> None:
    assert slipwise("convert", drive_csv, "-o", "drive.mcap").code == 0
    Path("cut.mcap").write_bytes(Path("drive.mcap").read_bytes()[:500])
    assert "(cut.mcap)" in refusal(slipwise, drive_csv.parent, "calibrate", "cut.mcap")


def test_a_bag_of_unknown_types_is_refused_with_what_it_has(slipwise: Slipwise, folder: Path) -> None:
    _bag_of_strings(folder / "strings")
    line = refusal(slipwise, folder, "calibrate", "strings")
    assert line.startswith("no topic with a measured pose (strings)")
    assert "/chatter (String)" in line


def test_a_topic_that_is_not_there_is_refused_with_those_that_are(
    slipwise: Slipwise, drive_csv: Path
) -> None:
    assert slipwise("convert", drive_csv, "-o", "drive.mcap").code == 0
    line = refusal(slipwise, drive_csv.parent, "calibrate", "drive.mcap", "--pose-topic", "/rtk")
    assert line.startswith("--pose-topic /rtk is not in the bag")
    assert "the bag has /" in line


def test_cells_that_are_not_finite_are_counted(slipwise: Slipwise, columns: Columns, folder: Path) -> None:
    columns["x"][[100, 200]] = np.nan, np.inf
    columns["yaw"][300] = -np.inf
    assert counts(slipwise, write_csv(folder / "nan.csv", columns))["non-finite"] == 3


def test_stamps_that_go_backward_are_counted(slipwise: Slipwise, columns: Columns, folder: Path) -> None:
    columns["t"][500:503] -= 5.0
    assert counts(slipwise, write_csv(folder / "back.csv", columns))["backward-stamp"] == 3 * 3


def test_zero_stamps_are_counted(slipwise: Slipwise, columns: Columns, folder: Path) -> None:
    columns["t"] += 100.0
    columns["t"][300:320] = 0.0
    found = counts(slipwise, write_csv(folder / "zero.csv", columns))
    assert found["backward-stamp"] == 3 * 20


def test_nothing_is_learned_across_a_gap_of_a_minute(
    slipwise: Slipwise, columns: Columns, folder: Path
) -> None:
    columns["t"][900:] += 60.0
    assert counts(slipwise, write_csv(folder / "gap.csv", columns)) == {"late-pose": 1}


def test_a_contradiction_is_refused_with_advice(slipwise: Slipwise, columns: Columns, folder: Path) -> None:
    """One of those in logs/test_quality.py."""
    columns["yaw"] = np.degrees(columns["yaw"])
    line = refusal(slipwise, folder, "calibrate", write_csv(folder / "wrong.csv", columns))
    assert line.startswith("yaw looks like degrees")
    assert "wrong.csv" in line
    assert "convert the poses' angles to radians" in line


@pytest.mark.parametrize("command", ["calibrate", "evaluate"])
def test_ten_rows_are_too_few(slipwise: Slipwise, columns: Columns, folder: Path, command: str) -> None:
    write_csv(folder / "ten.csv", {name: values[:10] for name, values in columns.items()})
    line = refusal(slipwise, folder, command, "ten.csv")
    assert line.startswith("the log has no window to learn from (ten.csv)")


@pytest.mark.parametrize("command", ["calibrate", "evaluate"])
def test_a_robot_that_never_moves_teaches_nothing(
    slipwise: Slipwise, columns: Columns, folder: Path, command: str
) -> None:
    for name in ("cmd_v", "cmd_omega", "odo_v", "odo_omega"):
        columns[name][:] = 0.0
    for name in ("x", "y", "yaw"):
        columns[name] = np.random.default_rng(1).normal(0.0, 0.002, len(columns["t"]))
    write_csv(folder / "still.csv", columns)
    line = refusal(slipwise, folder, command, "still.csv")
    assert line.startswith("the robot never moves in this log (still.csv)")


def test_a_file_that_is_no_model_is_refused(slipwise: Slipwise, drive_csv: Path) -> None:
    """Others stand in models/test_yaml_file.py and models/test_model.py."""
    for content, expected in [
        ("a: &a [x, x]\nb: [*a, *a]\n", "aliases are not allowed"),
        ("colour: blue\n", "is it a slipwise model?"),
    ]:
        Path("model.yaml").write_text(content)
        line = refusal(slipwise, drive_csv.parent, "evaluate", drive_csv, "--model", "model.yaml")
        assert "model.yaml" in line
        assert expected in line


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("basis = ", "not a TOML file"),
        ("basis = 'edd-3'", "unknown slip basis 'edd-3'; known are edd-2"),
    ],
)
def test_wrong_settings_are_refused(slipwise: Slipwise, drive_csv: Path, content: str, expected: str) -> None:
    Path("settings.toml").write_text(content)
    line = refusal(slipwise, drive_csv.parent, "calibrate", drive_csv, "--settings", "settings.toml")
    assert expected in line


def test_wrong_use_is_said_in_one_line(
    slipwise: Slipwise, drive_csv: Path, subtests: pytest.Subtests
) -> None:
    for arguments, expected in [
        (["--bogus"], "No such option: --bogus"),
        (["frobnicate"], "No such command 'frobnicate'"),
        (["calibrate"], "Missing argument 'LOG...'"),
        (["calibrate", "drive.csv", "--inptu", "wheel"], "No such option: --inptu"),
        (["calibrate", "drive.csv", "--input", "thrust"], "'thrust' is not one of"),
        (["calibrate", "drive.csv", "--wheel-separation", "wide"], "--wheel-separation"),
        (
            ["calibrate", "drive.csv", "--wheel-separation", "-1"],
            "wheel-separation must be a positive number of metres",
        ),
        (["evaluate", "drive.csv", "--horizons", "1,soon"], "'1,soon' is not a list of seconds (--horizons)"),
        (["evaluate", "drive.csv", "--horizons", "0"], "horizons must be positive seconds"),
        (["evaluate", "drive.csv", "--methods", "magic"], "unknown method 'magic'"),
        (["evaluate", "drive.csv", "--methods", "vendor"], "give --vendor-wheel-separation-multiplier"),
        (["evaluate", "drive.csv", "--methods", "none", "--report", "r.html"], "add auto to --methods"),
        (["evaluate", "drive.csv", "--horizons", "600"], "no two windows of any horizon"),
        (["convert", "drive.csv", "-o", "drive.doc"], "unknown kind of log file (drive.doc)"),
        (["simulate", "-o", "drive.csv", "--drive", "wild"], "unknown drive 'wild'"),
        (["simulate", "-o", "drive.csv", "--duration", "-5"], "duration is -5.0"),
        (["demo", "--duration", "nan"], "the demonstration lasts nan s"),
    ]:
        with subtests.test(arguments=arguments, expected=expected):
            assert expected in refusal(slipwise, drive_csv.parent, *arguments)


def test_the_process_itself_ends_with_one_line_and_2(process: Slipwise, folder: Path) -> None:
    assert refusal(process, folder, "calibrate", "no.csv") == "no such file (no.csv): check the path"


def test_control_characters_in_a_log_do_not_reach_the_terminal(
    slipwise: Slipwise, columns: Columns, folder: Path
) -> None:
    rows = np.column_stack([columns[name] for name in ("t", "cmd_v", "cmd_omega", "x", "y", "yaw")])
    rows[500, 0] = rows[499, 0]
    lines = [",".join(f"{value:.9g}" for value in row) + ",\x1b[2Jrun" for row in rows]
    Path("hostile.csv").write_text("\n".join(["t,cmd_v,cmd_omega,x,y,yaw,run", *lines]) + "\n")
    result = slipwise("inspect", "hostile.csv")
    assert result.code == 0
    assert "\x1b" not in result.out + result.err


def _bag_of_strings(path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    string: Any = store.types["std_msgs/msg/String"]
    with Writer(path, version=9) as writer:
        connection = writer.add_connection("/chatter", string.__msgtype__, typestore=store)
        for stamp in range(10):
            data = store.serialize_cdr(string(data="hello"), string.__msgtype__)
            writer.write(connection, stamp * 1_000_000_000, data)

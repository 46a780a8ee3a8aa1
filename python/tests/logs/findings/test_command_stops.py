# SPDX-License-Identifier: Apache-2.0
"""A watchdog is found by silences long ago, and from pieces of a stream as from the whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.live.command_stops import LiveCommandStops
from slipwise.live.recent_log import RecentLog
from slipwise.logs import Inputs, Log, LogOptions, Poses, Run, open_log, save_log
from slipwise.logs.command_timeout import with_ended_commands
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.findings.command_stops import CommandStops
from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.log import Floats
from slipwise.logs.measurements import Command, Pose
from slipwise.logs.row_reader import RowReader

DELAY, WAITS = 0.1, 0.4  # s


def drive(seconds: float, silent_until: float) -> tuple[Inputs, Poses]:
    """Commands at 10 Hz; until some time none in the last two of ten seconds, in which the robot stops."""
    t = np.round(np.arange(0.0, seconds, 0.1), 9)
    sent = (t % 10.0 < 8.0) | (t >= silent_until)
    age: Floats = t - DELAY - t[sent][np.maximum(np.searchsorted(t[sent], t - DELAY, side="right") - 1, 0)]
    x = np.concatenate(([0.0], np.cumsum(0.1 * np.where(age[:-1] < WAITS - 1e-6, 0.5, 0.0))))
    rest = np.zeros_like(t)
    commands = Inputs(t=t[sent], v=0.5 + rest[sent], vy=rest[sent], omega=rest[sent])
    return commands, Poses(t=t, x=x, y=rest, yaw=rest, frame=np.zeros(len(t), np.int64))


def pieces(commands: Inputs, poses: Poses, seconds: float) -> list[tuple[Inputs, Poses]]:
    """Both as a live node has them: the last command and the last pose of a piece begin the next."""
    found = []
    for begin in np.arange(0.0, poses.t[-1], seconds):
        p = (poses.t >= begin) & (poses.t <= begin + seconds)
        c = slice(
            max(int(np.searchsorted(commands.t, begin, side="right")) - 1, 0),
            int(np.searchsorted(commands.t, begin + seconds, side="right")),
        )
        found.append((commands.select(c), poses.select(p)))
    return found


@pytest.mark.parametrize(("seconds", "silent_until"), [(120.0, 120.0), (2400.0, 300.0)])
def test_silences_are_found_in_a_whole_log_and_in_its_pieces(seconds: float, silent_until: float) -> None:
    whole, live = CommandStops(), CommandStops()
    commands, poses = drive(seconds, silent_until)
    whole.add(commands, poses)
    for each in pieces(commands, poses, 30.0):
        live.add(*each)
    assert whole.after() == pytest.approx(WAITS, abs=0.051)
    assert live.after() == whole.after()
    assert whole.words(0.5) == live.words(0.5)


def test_parts_have_all_steps_and_the_command_in_force() -> None:
    motion = CommandedMotion.between(*drive(100.0, 100.0))
    assert motion is not None
    parts = motion.parts(30.0)
    np.testing.assert_array_equal(np.concatenate([each.start for each in parts]), motion.start)
    assert all(each.t[0] <= each.start[0] for each in parts)
    assert parts[-1].t[-1] == motion.t[-1]
    assert max(each.seconds for each in parts) < 30.2


def rare_commands(folder: Path) -> Path:
    """A robot that is commanded every second stops after half of it: `--command-timeout` is advised."""
    t = np.arange(0.0, 120.0, 0.05)
    speed = np.where(t // 10.0 % 2.0 == 0.0, 0.8, 0.5)
    x = np.cumsum(0.05 * np.where(t % 1.0 < 0.5, speed, 0.0))
    given = np.isclose(t % 1.0, 0.0, atol=1e-6) | np.isclose(t % 1.0, 1.0, atol=1e-6)
    rows = [
        f"{at:.2f},{f'{v},0' if said else ','},{place:.4f},0,0"
        for at, v, said, place in zip(t.tolist(), speed.tolist(), given.tolist(), x.tolist(), strict=True)
    ]
    path = folder / "rare.csv"
    path.write_text("t,cmd_v,cmd_omega,x,y,yaw\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def test_zeros_of_a_watchdog_that_was_given_are_no_second_source(tmp_path: Path) -> None:
    path = rare_commands(tmp_path)
    (found,) = findings_of(open_log(path), "command")
    assert found.kind == "command-timeout"
    assert found.evidence == pytest.approx(0.5, abs=0.051)
    assert findings_of(open_log(path, command_timeout=0.5), "command") == ()


@pytest.mark.parametrize("given", [0.2, 0.8])
def test_a_wrong_timeout_is_named_with_the_right_one(tmp_path: Path, given: float) -> None:
    (found,) = findings_of(open_log(rare_commands(tmp_path), command_timeout=given), "command")
    assert found.sentence.startswith(f"commands are said to end {given:g} s after each")
    assert found.advice[0].startswith("Give --command-timeout")
    assert found.evidence == pytest.approx(0.5, abs=0.051)
    assert found.spoils


def test_a_wrong_timeout_is_named_live_too() -> None:
    commands, poses = drive(120.0, 120.0)
    stops = LiveCommandStops(0.5, given=1.0)
    for t, v, omega in zip(commands.t.tolist(), commands.v.tolist(), commands.omega.tolist(), strict=True):
        stops.take_command(Command(t, v, omega))
    stops.take_command(Command(float(commands.t[-1]) + 0.01, 0.0, 0.0, ended=True))
    for t, x in zip(poses.t.tolist(), poses.x.tolist(), strict=True):
        stops.take_pose(Pose(t, x, 0.0, 0.0), 0)
    (found,) = stops.found()
    assert found.evidence == pytest.approx(WAITS, abs=0.051)


def test_a_timeout_of_a_robot_that_has_none_is_named() -> None:
    commands, _ = drive(120.0, 120.0)
    t = np.arange(0.0, 120.0, 0.1)
    rest = np.zeros_like(t)
    poses = Poses(t=t, x=0.5 * t, y=rest, yaw=rest, frame=np.zeros(len(t), np.int64))
    log = with_ended_commands(Log(runs=(Run("a", commands, None, poses),)), WAITS)
    named = [each for each in findings_of(log, "command") if each.kind == "command-timeout"]
    assert [each.advice for each in named] == [("Leave --command-timeout away.",)]


@pytest.mark.parametrize("ending", ["csv", "csv.gz", "parquet"])
def test_zeros_of_a_watchdog_are_known_in_the_table_that_was_converted(tmp_path: Path, ending: str) -> None:
    log = open_log(rare_commands(tmp_path), command_timeout=0.5)
    assert save_log(log, tmp_path / f"converted.{ending}") == ()
    again = open_log(tmp_path / f"converted.{ending}")
    given, read = log.runs[0].commands, again.runs[0].commands
    assert given is not None
    assert read is not None
    assert given.ended is not None
    assert read.ended is not None
    np.testing.assert_array_equal(read.rows(), given.rows())
    np.testing.assert_array_equal(read.ended, given.ended)
    assert int(read.ended.sum()) == 3 * 119
    assert findings_of(again, "command") == ()


def test_zeros_of_a_watchdog_are_not_written_as_messages(tmp_path: Path) -> None:
    """A topic holds what was sent; the option is given again with the bag."""
    log = open_log(rare_commands(tmp_path), command_timeout=0.5)
    (left_out,) = save_log(log, tmp_path / "converted.mcap")
    assert left_out.reason.startswith("commands that a watchdog holds or ends (--command-timeout)")
    assert left_out.count == 3 * 119
    (found,) = findings_of(open_log(tmp_path / "converted.mcap"), "command")
    assert found.kind == "command-timeout"
    assert findings_of(open_log(tmp_path / "converted.mcap", command_timeout=0.5), "command") == ()


def test_a_second_source_is_found_beside_a_watchdog_that_was_given() -> None:
    t = np.round(np.arange(0.0, 120.0, 0.1), 9)
    rest, speed = np.zeros_like(t), np.where(t % 20.0 < 10.0, 0.8, 0.5)
    x = np.cumsum(0.1 * speed)
    idle = np.sort(np.concatenate((t, t[1::2] - 0.05)))
    v = np.where(np.isin(idle, t), np.interp(idle, t, speed), 0.0)
    commands = Inputs(t=idle, v=v, vy=0.0 * v, omega=0.0 * v)
    poses = Poses(t=t, x=x, y=rest, yaw=rest, frame=np.zeros(len(t), np.int64))
    log = with_ended_commands(Log(runs=(Run("a", commands, None, poses),)), 0.5)
    assert "two-sources" in {each.kind for each in findings_of(log, "command")}


def test_a_live_node_hears_no_second_source_in_zeros_of_a_log_or_of_a_line() -> None:
    marked, sent = RecentLog("command", 0.5), RecentLog("command", 0.5)
    for k in range(2400):
        t, run = 0.05 * k, k % 20 < 10
        for recent, ended in ((marked, True), (sent, False)):
            if k % 20 == 0:
                recent.take(Command(t, 0.8, 0.0))
            elif k % 20 in (10, 14, 18):
                recent.take(Command(t, 0.0, 0.0, ended=ended))
            recent.take(Pose(t, 0.4 * (k // 20) + 0.04 * (k % 20 if run else 10), 0.0, 0.0))
            recent.found()
    assert marked.found() == ()
    assert "two-sources" in {each.kind for each in sent.found()}
    row = RowReader(LogOptions()).read(
        {"t": "1", "cmd_v": "0", "cmd_omega": "0", "cmd_ended": "1"}, ("t", "cmd_v", "cmd_omega", "cmd_ended")
    )
    assert row.measurements == [Command(1.0, 0.0, 0.0, ended=True)]
    plain = RowReader(LogOptions()).read(
        {"t": "1", "cmd_v": "0", "cmd_omega": "0"}, ("t", "cmd_v", "cmd_omega")
    )
    assert plain.measurements == [Command(1.0, 0.0, 0.0)]

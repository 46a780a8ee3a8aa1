# SPDX-License-Identifier: Apache-2.0
"""A robot whose watchdog ends commands: the cause is named with its option, which gives the truth."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from sample_bags import TWIST, Bag
from sample_field import (
    FieldDrive,
    field_drive,
    field_path,
    is_released,
    learned,
    recorder,
    share_errors,
    write_poses,
)
from scripted_node import Scripted

from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.prepared_run import PreparedRun
from slipwise.errors import LogError, SettingsError
from slipwise.live.build import build_node
from slipwise.live.command_stops import COMES_WITHIN, CommandEnds
from slipwise.live.replay import samples_of
from slipwise.live.samples import Command, Pose
from slipwise.logs import Inputs, LogOptions, Poses, open_log
from slipwise.logs.findings.command_stops import stops_of
from slipwise.logs.findings.diagnose import diagnose


def rare_commands(tmp_path: Path, drive: FieldDrive, period: float) -> Path:
    bag = Bag()
    write_poses(bag, drive)
    for k in drive.every(period):
        bag.add(recorder(drive.t[k]), "/cmd_vel", TWIST, bag.twist(*map(float, drive.command[k])))
    return bag.write(tmp_path / "rare.mcap")


def test_a_watchdog_is_named_with_the_option() -> None:
    path = field_path("cmd_timeout.mcap")
    words = r"commands come every 1.3 s, and the robot stops about 0.5 s after each.*--command-timeout 0.5"
    with pytest.raises(LogError, match=words):
        learned(path)
    held = calibrate(open_log(path), settings=make_settings({"segment": {"unknown_after": 3.0}}))
    assert not held.verdict.good
    assert "the robot stops about 0.5 s after each" in held.verdict.sentence
    result, said = learned(path, command_timeout=0.5)
    assert result.verdict.good
    assert "commands end 0.5 s after each, as given: 75 were not repeated in that time" in said
    assert np.abs(share_errors(result.model)).max() < 3.0


@pytest.mark.parametrize(("timeout", "period"), [(0.4, 1.0), (0.6, 2.0), (1.0, 1.6)])
def test_how_long_a_watchdog_waits_is_found(tmp_path: Path, timeout: float, period: float) -> None:
    drive = field_drive(180.0, hold=period, period=period, timeout=timeout)
    with pytest.raises(LogError, match=rf"stops about {timeout:g} s after each"):
        learned(rare_commands(tmp_path, drive, period))


def deadman_log(tmp_path: Path, timeout: float, hold: float = 1.5) -> Path:
    """Commands at 10 Hz while a stick is held, and none where it is released."""
    drive = field_drive(150.0, hold=hold, timeout=timeout, deadman=True)
    bag = Bag()
    write_poses(bag, drive)
    for k in drive.every(0.1):
        if not is_released(drive.t[k : k + 1], hold)[0]:
            bag.add(recorder(drive.t[k]), "/cmd_vel", TWIST, bag.twist(*map(float, drive.command[k])))
    return bag.write(tmp_path / "deadman.mcap")


@pytest.mark.parametrize("timeout", [0.25, 0.5])
def test_a_watchdog_is_found_by_rare_silences_of_a_stream(tmp_path: Path, timeout: float) -> None:
    path = deadman_log(tmp_path, timeout)
    verdict = learned(path)[0].verdict
    assert not verdict.good
    (said,) = verdict.contradictions
    assert said == (
        "commands come every 0.1 s, with longer silences, and the robot stops about "
        f"{timeout:g} s after the last of them"
    )
    (found,) = diagnose(path, LogOptions()).found
    assert (found.kind, found.spoils) == ("command-timeout", True)
    assert found.advice[0].startswith(f"Give --command-timeout {timeout:g}:")
    result = learned(path, command_timeout=timeout)[0]
    assert result.verdict.good
    assert np.abs(share_errors(result.model)).max() < 3.0


def test_a_robot_that_goes_on_in_silences_has_no_watchdog(tmp_path: Path) -> None:
    path = deadman_log(tmp_path, np.inf)
    assert diagnose(path, LogOptions()).found == ()
    assert learned(path)[0].verdict.good


def test_silences_of_a_robot_that_was_told_to_stand_show_no_watchdog() -> None:
    """Every third hold ends with a zero before the silence."""
    t = np.arange(0.0, 150.0, 0.1)
    v = np.where(is_released(t, 1.5), 0.0, 0.6)
    x = np.concatenate(([0.0], np.cumsum(0.1 * v[:-1])))
    rest = np.zeros_like(t)
    sent = (v != 0.0) | (np.concatenate(([1.0], v[:-1])) != 0.0)
    commands = Inputs(t=t[sent], v=v[sent], vy=rest[sent], omega=rest[sent])
    stops = stops_of([(commands, Poses(t=t, x=x, y=rest, yaw=rest, frame=np.zeros(len(t), np.int64)))])
    assert stops.after() is None
    assert stops.words(0.5) is None


def test_a_robot_that_holds_its_commands_is_told_of_unknown_after(tmp_path: Path) -> None:
    drive = field_drive(120.0, hold=1.5, period=1.5)
    path = rare_commands(tmp_path, drive, 1.5)
    with pytest.raises(LogError, match=r"commands come every 1.5 s and count as unknown.*unknown_after"):
        learned(path)
    result = calibrate(open_log(path), settings=make_settings({"segment": {"unknown_after": 3.0}}))
    assert not result.verdict.contradictions


@pytest.mark.parametrize("seconds", [0.5, 0.9])
def test_live_ends_commands_at_the_stamps_of_the_log(seconds: float, tmp_path: Path) -> None:
    drive = field_drive(30.0, hold=1.2, period=1.2, timeout=seconds)
    path = rare_commands(tmp_path, drive, 1.2)
    before = open_log(path).runs[0]
    after = open_log(path, options=LogOptions(command_timeout=seconds)).runs[0]
    assert before.commands is not None
    assert after.commands is not None
    samples = [
        *(Command(*row) for row in before.commands.rows()[:, [0, 1, 3, 2]].tolist()),
        *(Pose(t, 0.0, 0.0, 0.0) for t in before.poses.t),
    ]
    ends, given = CommandEnds(seconds), []
    for sample in sorted(samples, key=lambda each: each.t):
        given += ends.before(sample)
        given += [sample] if isinstance(sample, Command) else []
    until = before.poses.t[-1] - COMES_WITHIN
    rows = np.array([(each.t, each.v, each.vy, each.omega) for each in given])
    np.testing.assert_array_equal(rows, after.commands.rows()[: len(rows)])
    assert after.commands.t[len(rows) :].min(initial=np.inf) >= until


def test_a_command_is_known_until_its_watchdog_ends_it(tmp_path: Path) -> None:
    given = ["0.0,1.0,0.5,0,0,0", "3.0,0.5,0.1,1,0,0"]
    poses = [f"{0.1 * k:.1f},,,{0.01 * k},0,0" for k in range(1, 50) if k != 30]
    (tmp_path / "a.csv").write_text("\n".join(["t,cmd_v,cmd_omega,x,y,yaw", *given, *poses, ""]))
    commands = open_log(tmp_path / "a.csv", command_timeout=1.4).runs[0].commands
    assert commands is not None
    first = commands.t < 2.9
    assert commands.v[first & (commands.t < 1.4)].tolist() == [1.0] * 4
    assert commands.t[first & (commands.v == 0.0)].tolist() == pytest.approx(1.4 + 0.2 * np.arange(8))
    assert np.diff(commands.t).max() < 0.5
    assert commands.sent.t.tolist() == [0.0, 3.0]  # a zero of the same stamp gives way


@pytest.mark.parametrize("unknown_after", [0.5, 3.0])
def test_a_watchdog_is_found_live_too(unknown_after: float) -> None:
    log = open_log(field_path("cmd_timeout.mcap"))
    run = log.runs[0]
    assert run.commands is not None
    transport = Scripted(samples_of(PreparedRun(0, run, run.commands, None)))
    settings = make_settings({"segment": {"unknown_after": unknown_after}})
    built = build_node(transport, "command", settings, run="live")
    built.node.run()
    words = r".* and the robot stops about (0.5\d?) s after each. Give --command-timeout \1"
    assert any(re.match(words, text) for text in transport.said)
    model = built.learning.model
    assert model is None or not model.content.verdict.good
    if unknown_after > 1.3:
        wanted = calibrate(log, settings=settings).verdict
        assert model is not None
        assert model.content.verdict.sentence == wanted.sentence


def test_an_impossible_timeout_is_refused() -> None:
    with pytest.raises(SettingsError, match="--command-timeout must be a positive number of seconds"):
        LogOptions(command_timeout=0.0)

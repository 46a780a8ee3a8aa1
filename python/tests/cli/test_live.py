# SPDX-License-Identifier: Apache-2.0
"""`slipwise live` as a user runs it: as a process, with signals, a pipe and a settings file."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from sample_logs import simulated_log
from sample_slopes import Hills, hilly_log
from scripted_node import SLIP

import slipwise as sw
from slipwise.cli.main import run

SLIPWISE = (sys.executable, "-m", "slipwise")
GRACE = 2.0  # s to end after a signal, and some for a busy machine
BUSY = 5.0


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("live") / "drive.csv"
    sw.save_log(simulated_log(SLIP), path)
    return path


def test_with_a_memory_a_log_is_replayed_into_the_model_that_calibrate_writes_with_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hills, live, log = tmp_path / "hills.csv", tmp_path / "live.yaml", tmp_path / "calibrate.yaml"
    sw.save_log(hilly_log(1, Hills(seconds=60.0)), hills)
    monkeypatch.chdir(tmp_path)
    replay = ["live", "--replay", str(hills), "--rate", "0", "--quiet"]
    assert run([*replay, "--memory", "--surface", "grass", "-o", str(live)]) == 0
    learn = ["calibrate", "--memory", "--no-report"]
    assert run([*learn, str(hills), "--surface", "grass", "-o", str(log)]) in (0, 1)
    assert live.read_bytes() == log.read_bytes()
    assert [each.name for each in sw.load_model(live).content.surfaces] == ["grass"]
    assert "gy" in live.read_text(encoding="utf-8")
    on, on_too = tmp_path / "on.yaml", tmp_path / "on-too.yaml"
    assert run([*learn, str(log), str(hills), "-o", str(on)]) in (0, 1)
    assert run([*replay, "--memory", "--model", str(live), "-o", str(on_too)]) == 0
    assert on_too.read_bytes() == on.read_bytes()


def test_labels_without_a_memory_are_refused(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["live", "--replay", str(drive), "--rate", "0", "--surface", "sand"]) == 2
    assert "add --memory" in capsys.readouterr().err


def test_a_speed_of_what_is_not_replayed_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["live", "--transport", "stdin", "--rate", "10"]) == 2
    assert "samples come as they are sent (--rate): give --replay with it" in capsys.readouterr().err


def wait_until_under_way(process: subprocess.Popen[str]) -> None:
    """Until the process has said where it stands, and learned for four seconds more."""
    assert process.stdout is not None
    assert process.stdout.readline()
    time.sleep(4.0)


@pytest.mark.slow
def test_a_process_that_is_killed_loses_what_came_after_the_last_save_and_the_next_goes_on(
    drive: Path, tmp_path: Path
) -> None:
    cache = ["--cache", str(tmp_path)]
    common = [*SLIPWISE, "live", "--replay", str(drive), *cache, "--input", "wheel", "--memory"]
    first = subprocess.run([*common, "--rate", "0"], capture_output=True, text=True, check=True)
    assert "goes on from" not in first.stdout
    assert (tmp_path / "robot-wheel.yaml").exists()
    saved = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    command = [*common, "--rate", "5"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as live:
        wait_until_under_way(live)  # and before the first save after 60 s
        assert live.poll() is None
        live.kill()
        live.communicate(timeout=30.0)
    left = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.suffix != ".starts"}
    assert left == saved
    again = subprocess.run([*common, "--rate", "0"], capture_output=True, text=True, check=True)
    assert "goes on from" in again.stdout


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_with_the_cache_written(drive: Path, tmp_path: Path, number: signal.Signals) -> None:
    cache = tmp_path / "cache"
    command = [*SLIPWISE, "live", "--replay", str(drive), "--rate", "5", "--cache", str(cache)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_until_under_way(process)
        process.send_signal(number)
        began = time.monotonic()
        _, error = process.communicate(timeout=30.0)
        assert time.monotonic() - began < GRACE + BUSY
    assert process.returncode == 0
    assert error == ""
    assert (cache / "robot-command.state").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("lines", [0, 400])
def test_a_signal_ends_it_while_a_writer_lives_whether_lines_came_or_not(
    drive: Path, tmp_path: Path, number: signal.Signals, lines: int
) -> None:
    cache = tmp_path / "cache"
    command = [*SLIPWISE, "live", "--transport", "stdin", "--cache", str(cache)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.writelines(drive.read_text().splitlines(keepends=True)[:lines])
        process.stdin.flush()
        awaited = "learning from" if lines else "waiting for the first lines"
        while awaited not in process.stdout.readline():
            assert process.poll() is None
        time.sleep(0.5)
        process.send_signal(number)
        process.wait(30.0)
        assert (process.returncode, process.stderr.read() if process.stderr else "") == (0, "")


@pytest.mark.slow
def test_lines_on_a_pipe_are_answered_with_lines(drive: Path) -> None:
    (only,) = sw.open_log(drive).runs
    wheels = only.wheels
    assert wheels is not None
    poses = only.poses
    rows = zip(wheels.t, wheels.v, wheels.omega, poses.x, poses.y, poses.yaw, strict=True)
    lines = ["t,odo_v,odo_omega,x,y,yaw", *(",".join(repr(float(value)) for value in row) for row in rows)]
    lines.append(json.dumps({"predict": {"horizon": 1.0, "commands": [[float(wheels.t[-1]), 0.5, 0.0]]}}))
    done = subprocess.run(
        [*SLIPWISE, "live", "--transport", "stdin", "--results", "-"],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=True,
    )
    said = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.stderr == ""
    assert any("prediction" in each for each in said)
    assert any("model" in each for each in said)
    assert said[-1]["validity"] == "estimated"


def test_settings_stand_in_a_file_and_the_command_line_goes_before_it(tmp_path: Path) -> None:
    drive, settings = tmp_path / "drive.csv", tmp_path / "live.toml"
    sw.save_log(simulated_log(replace(SLIP, seconds=20.0)), drive)
    settings.write_text(
        f'basis = "edd-2"\n[live]\nname = "from-file"\ncache = "{tmp_path}/cache"\ninput = "wheel"\n'
    )
    given = ["live", "--replay", str(drive), "--rate", "0", "--settings", str(settings), "--quiet"]
    assert run(given) == 0
    assert run([*given, "--name", "from-line"]) == 0
    assert sorted(path.name for path in (tmp_path / "cache").glob("*.state")) == [
        "from-file-wheel.state",
        "from-line-wheel.state",
    ]


def test_what_cannot_be_is_one_line(capsys: pytest.CaptureFixture[str], subtests: pytest.Subtests) -> None:
    for options, said in [
        (["--transport", "carrier-pigeon"], "transport"),
        (["--set", "live.apply.mode=always"], "apply"),
        (["--set", "live.node=two words"], "node"),
        (["--set", "live.network=maybe"], "network"),
        (["--replay", "nowhere.csv"], "no such file"),
        (["--replay", "nowhere.csv", "--transport", "udp"], "leave one of the two out"),
        (["--replay", "nowhere.csv", "--results", "said.jsonl"], "--transport stdin"),
        (["--transport", "udp", "--results", "-"], "--transport stdin"),
        (["--transport", "udp", "--set", "live.address=nowhere"], "cannot listen"),
    ]:
        with subtests.test(options=options, said=said):
            assert run(["live", *options]) == 2
            (line,) = capsys.readouterr().err.splitlines()
            assert said in line

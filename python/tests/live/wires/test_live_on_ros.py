# SPDX-License-Identifier: Apache-2.0
"""A bag played by a real ROS 2 node teaches `slipwise live` what `calibrate` learns from the bag."""

from __future__ import annotations

import base64
import json
import os
import signal
import subprocess
import sys
import sysconfig
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from live.wires.peer import DOMAIN, HERE
from sample_logs import simulated_log
from sample_surfaces import FIRM, LOOSE, floor_log, model_of_floors
from scripted_node import SLIP

import slipwise as sw
from slipwise.live.wires.ros_types import ros_types
from slipwise.logs.bag_file import BagFile, bag_files
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Log
from slipwise.models import load_model

pytestmark = pytest.mark.slow

#: Times real time. Streams may be late by half a second of stamps: where the machine is busy, more slowly.
RATES = (6.0, 2.0)
ROS = {"ROS_DOMAIN_ID": str(DOMAIN), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bag") / "drive.mcap"
    sw.save_log(later(simulated_log(SLIP), 100.0), path)
    return path


def later(log: Log, seconds: float) -> Log:
    """The same log by another clock: to ROS a stamp of zero is none."""
    (run,) = log.runs
    assert run.commands is not None
    assert run.wheels is not None
    parts = {
        name: replace(part, t=part.t + seconds) for name, part in vars(run).items() if hasattr(part, "t")
    }
    return Log(runs=(replace(run, **parts),))


def messages(bag: Path, file: Path) -> Path:
    """Write the messages of a bag as the player reads them."""
    lines = []
    with BagFile(bag, bag_files(bag), Tally()) as opened:
        types = {topic.name: topic.type for topic in opened.topics if topic.name.startswith("/")}
        wanted = {name for name, kind in types.items() if not kind.startswith("std_msgs")}
        lines = [
            {
                "t": message.received_ns / 1e9,
                "topic": message.topic,
                "type": types[message.topic],
                "message": base64.b64encode(bytes(message.data)).decode(),
            }
            for message in opened.messages(wanted)
        ]
    file.write_text("\n".join(json.dumps(line) for line in lines))
    return file


def without_origin(text: str) -> str:
    return "\n".join(line for line in text.splitlines() if "sha256" not in line and "logs:" not in line)


def played(lines: Path, ros_python: Path, command: list[str], rate: float = RATES[0]) -> dict[str, Any]:
    """Run the node while a real ROS 2 node plays; return what that one heard, and what the node said."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")} | ROS
    player = [str(ros_python), str(HERE / "bag_player.py"), str(lines), str(rate)]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as live:
        done = subprocess.run(
            player, check=False, env=environment, capture_output=True, text=True, timeout=120.0
        )
        live.send_signal(signal.SIGTERM)
        said, error = live.communicate(timeout=30.0)
    assert done.returncode == 0, done.stderr
    assert live.returncode == 0, error
    return dict(json.loads(done.stdout.splitlines()[-1])) | {"said": said}


def command_of(transport: str, ros_python: Path, output: Path) -> list[str]:
    ours = (
        f"import site; site.addsitedir({sysconfig.get_path('purelib')!r}); "
        "from slipwise.cli.main import main; main()"
    )
    start = [sys.executable, "-m", "slipwise"] if transport == "cyclonedds" else [str(ros_python), "-c", ours]
    return [*start, "live", "--transport", transport, "-o", str(output)]


@pytest.mark.parametrize("transport", ["cyclonedds", "rclpy"])
def test_a_bag_played_by_a_real_node_gives_the_model_of_the_bag(
    bag: Path, ros_python: Path, tmp_path: Path, transport: str
) -> None:
    output = tmp_path / "live.yaml"
    lines, command = messages(bag, tmp_path / "lines"), command_of(transport, ros_python, output)
    wanted = without_origin(sw.calibrate(sw.open_log(bag), input="command").model.to_yaml())
    for rate in RATES:
        found = played(lines, ros_python, command, rate)
        if without_origin(output.read_text()) == wanted:
            break
    assert without_origin(output.read_text()) == wanted
    assert "pose topic: /ground_truth/pose" in found["said"]
    assert "slipwise" in found["nodes"]
    assert found["frame"]
    assert found["model"].startswith("# slipwise live, robot")
    assert found["moves"] == 3
    assert found["heard"]["odometry"] > 100
    assert found["heard"]["twist"] == found["heard"]["odometry"]
    assert min(found["heard"][name] for name in ("predicted_path", "diagnostics")) > 10


def told(lines: Path, said: dict[str, tuple[str, dict[str, str]]]) -> Path:
    """Add messages to a drive: at a third of it, what each topic says."""
    rows = [json.loads(line) for line in lines.read_text().splitlines()]
    at = len(rows) // 3
    store = ros_types()
    for topic, (kind, content) in said.items():
        payload = bytes(store.serialize_cdr(store.types[kind](**content), kind))
        text = base64.b64encode(payload).decode()
        rows.insert(at, {"t": rows[at]["t"], "topic": topic, "type": kind, "message": text})
    lines.write_text("\n".join(json.dumps(row) for row in rows))
    return lines


@pytest.mark.parametrize("transport", ["cyclonedds", "rclpy"])
def test_a_real_node_names_the_surface_and_hears_which_one_it_is(
    ros_python: Path, tmp_path: Path, transport: str
) -> None:
    floors, bag, output = (tmp_path / name for name in ("floors.yaml", "drive.mcap", "live.yaml"))
    model_of_floors(FIRM, LOOSE, labels=("hall", "sand")).save(floors)
    sw.save_log(later(floor_log(LOOSE, 21), 100.0), bag)
    lines = told(
        messages(bag, tmp_path / "lines"),
        {
            "/slipwise/terrain_changed": ("std_msgs/msg/Empty", {}),
            "/label": ("std_msgs/msg/String", {"data": "hall"}),  # a wrong one: it is overruled
            "/slipwise/terrain": ("std_msgs/msg/String", {"data": "hall"}),
        },
    )
    command = command_of(transport, ros_python, output)
    command += ["--input", "wheel", "--memory", "--model", str(floors), "--set", "live.surface_topic=/label"]
    found = played(lines, ros_python, command)
    known = found["surfaces"]
    assert (found["surface"], known["names"][0], known["probabilities"][0]) == ("sand", "sand", 1.0)
    assert known["remembered"] == ["hall", "sand"]
    judged, right = known["labels"]
    assert judged > right
    assert found["heard"]["surfaces"] > 10
    assert {each.name for each in load_model(output).content.surfaces} == {"hall", "sand"}

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

import pytest
from live.wires.peer import DOMAIN, HERE
from sample_logs import simulated_log
from scripted_node import SLIP

import slipwise as sw
from slipwise.logs.bag_file import BagFile, bag_files
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Log

pytestmark = pytest.mark.slow

RATE = 6.0  # times real time; streams may be late by half a second of stamps
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


@pytest.mark.parametrize("transport", ["cyclonedds", "rclpy"])
def test_a_bag_played_by_a_real_node_gives_the_model_of_the_bag(
    bag: Path, ros_python: Path, tmp_path: Path, transport: str
) -> None:
    python = sys.executable if transport == "cyclonedds" else str(ros_python)
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")} | ROS
    ours = (
        f"import site; site.addsitedir({sysconfig.get_path('purelib')!r}); "
        "from slipwise.cli.main import main; main()"
    )
    start = ["-m", "slipwise"] if transport == "cyclonedds" else ["-c", ours]
    command = [python, *start, "live", "--transport", transport, "--domain", str(DOMAIN)]
    output = tmp_path / "live.yaml"
    player = [str(ros_python), str(HERE / "bag_player.py"), str(messages(bag, tmp_path / "lines")), str(RATE)]
    with subprocess.Popen(
        [*command, "-o", str(output)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as live:
        played = subprocess.run(
            player, check=False, env=environment, capture_output=True, text=True, timeout=120.0
        )
        live.send_signal(signal.SIGTERM)
        said, error = live.communicate(timeout=30.0)
    assert played.returncode == 0, played.stderr
    assert live.returncode == 0, error
    assert "pose topic: /ground_truth/pose" in said
    wanted = sw.calibrate(sw.open_log(bag)).model.to_yaml()
    assert without_origin(output.read_text()) == without_origin(wanted)
    found = json.loads(played.stdout.splitlines()[-1])
    assert "slipwise" in found["nodes"]
    assert found["frame"]
    assert found["model"].startswith("# slipwise live, robot")
    assert found["heard"]["odometry"] > 100
    assert found["heard"]["twist"] == found["heard"]["odometry"]
    assert min(found["heard"][name] for name in ("predicted_path", "diagnostics")) > 10

# SPDX-License-Identifier: Apache-2.0
"""The ROS package slipwise_ros, built by colcon, is managed, taught and asked by a real ROS 2 node."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sysconfig
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from live.typed_model import assert_same_numbers
from live.wires.launched import ros_arguments
from live.wires.peer import ROOT, Peer
from live.wires.test_live_on_ros import RATES, ROS, later, messages, without_origin
from sample_logs import simulated_log
from scripted_node import SLIP

import slipwise as sw
from slipwise.calibration import Settings
from slipwise.live.cache import Cache, CacheKey
from slipwise.live.ros_messages import TOPICS
from slipwise.live.wires.ros_types import ros_types
from slipwise.models.model import parse_model

NODE = "/robot_1/slipwise"
LAUNCH_FILE = ROOT / "ros/slipwise_ros/launch/live.launch.xml"
START = (
    f"import site; site.addsitedir({sysconfig.get_path('purelib')!r}); "
    "from slipwise_ros.live import main; main()"
)


def parameters(cache: Path) -> list[str]:
    given = {"name": "husky-1", "cache": str(cache), "pose_topic": "pose", "command_topic": "/cmd_vel"}
    said = [f"{name}:={value}" for name, value in given.items()]
    remaps = ["__ns:=/robot_1", "pose:=/ground_truth/pose"]
    return [
        "--ros-args",
        *(x for each in said for x in ("-p", each)),
        *(x for r in remaps for x in ("-r", r)),
    ]


@contextmanager
def slipwise_ros(python: Path, arguments: list[str]) -> Iterator[subprocess.Popen[str]]:
    """Run the node as `ros2 run slipwise_ros live` does."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")} | ROS
    environment["PYTHONFAULTHANDLER"] = "1"
    with subprocess.Popen(
        [str(python), "-c", START, *arguments], env=environment, stderr=subprocess.PIPE, text=True
    ) as node:
        try:
            yield node
        finally:
            node.kill()


def ended(node: subprocess.Popen[str]) -> tuple[int, str]:
    """Return the exit code of an interrupted node; what it said too, if that is wrong or it does not end."""
    try:
        code = node.wait(30.0)
        return code, node.stderr.read() if code and node.stderr else ""
    except subprocess.TimeoutExpired:
        node.send_signal(signal.SIGABRT)
        return node.wait(10.0), node.stderr.read() if node.stderr else ""


def learned(cache: Path) -> Any:
    """Return the model of what a cache has learned."""
    opened = Cache(cache, CacheKey.of("husky-1", "command", Settings()))
    found = opened.load()
    opened.close()
    assert found.learner is not None, found.said
    return found.learner.judged_model()[0]


def typed(name: str, text: str) -> Any:
    kind = f"slipwise_msgs/msg/{name}"
    payload = bytes.fromhex(text)
    for padding in range(0, 16, 4):  # Fast CDR may add zeros behind
        try:
            return ros_types().deserialize_cdr(payload[: len(payload) - padding], kind)
        except Exception:
            continue
    raise AssertionError(name)


@pytest.mark.slow
def test_a_managed_node_learns_what_calibrate_does_and_answers(ros_python: Path, tmp_path: Path) -> None:
    bag, cache = tmp_path / "drive.mcap", tmp_path / "cache"
    sw.save_log(later(simulated_log(SLIP), 100.0), bag)
    lines = messages(bag, tmp_path / "lines")
    wanted = without_origin(sw.calibrate(sw.open_log(bag), input="command").model.to_yaml())
    with (
        slipwise_ros(ros_python, parameters(cache)) as node,
        Peer(ros_python, "lifecycle_node.py", NODE, environment=ROS, patience=180.0) as peer,
    ):
        assert peer.ask("state") == "unconfigured"
        assert peer.ask("describe", names=["pose_topic"])["pose_topic"].startswith("Measured pose")
        assert peer.ask("set", name="live.apply.mode", value="never") == [True, ""]
        assert not peer.ask("change", to="configure")  # there is no such mode
        assert peer.ask("set", name="live.apply.mode", value="manual") == [True, ""]
        assert peer.ask("change", to="configure")
        done, why = peer.ask("set", name="name", value="other")
        assert (done, why.split(":")[0]) == (False, "name")
        assert peer.ask("trigger", service="save") == [False, "the node is not active"]
        for rate in RATES:
            assert peer.ask("change", to="activate")
            assert peer.ask("state") == "active"
            peer.ask("play", file=str(lines), rate=rate)
            ahead = peer.ask("predict", horizon=2.0, t=[0.0, 1.0], v=[1.0, 1.0], omega=[0.0, 0.5])
            assert ahead["success"], ahead
            assert ahead["n"] == 9 * len(ahead["path"])
            assert not peer.ask("predict", horizon=2.0, t=[0.0], v=[], omega=[0.1, 0.2])["success"]
            heard = peer.ask("heard")
            assert peer.ask("change", to="deactivate")
            found = learned(cache)
            if without_origin(found.to_yaml()) == wanted:
                break
            assert peer.ask("change", to="activate")
            assert peer.ask("trigger", service="reset")[0]
            assert peer.ask("change", to="deactivate")
        assert without_origin(found.to_yaml()) == wanted
        model = typed("MotionModel", heard["motion_model"])
        assert_same_numbers(model, parse_model(heard["model"], where="the topic").content)
        assert (model.vehicle, model.given) == ("husky-1", "valid")
        assert heard["count"]["odometry"] > 100
        state = typed("SlipState", heard["slip_state"])
        assert (state.state, state.validity) == ("learning", model.ESTIMATED)
        assert peer.ask("change", to="activate")
        assert "waits for" in peer.ask("trigger", service="save")[1]
        peer.ask("play", file=str(beginning(lines)), rate=RATES[0])  # too little to learn from nothing
        done, where = peer.ask("trigger", service="save")
        assert (done, where) == (True, f"saved in {cache / 'husky-1-command.state'}")
        assert peer.ask("freeze", on=True) == [True, "learning is frozen"]
        assert peer.ask("trigger", service="apply") == [True, "the parameters learned are applied"]
        assert peer.ask("trigger", service="reset") == [True, "learning begins from nothing"]
        assert peer.ask("change", to="deactivate")
        assert peer.ask("change", to="cleanup")
        assert peer.ask("state") == "unconfigured"
        node.send_signal(signal.SIGINT)
        assert ended(node) == (0, "")


def beginning(lines: Path) -> Path:
    """Return a file with the first of the messages."""
    first = lines.with_name("first")
    first.write_text("\n".join(lines.read_text().splitlines()[:800]))
    return first


@pytest.mark.slow
@pytest.mark.parametrize(("apply", "mode"), [("off", False), ("manual", "manual")])  # to YAML, off is false
def test_the_node_starts_with_the_arguments_of_its_launch_file(
    ros_python: Path, tmp_path: Path, apply: str, mode: object
) -> None:
    given = {"namespace": "robot_1", "name": "husky-1", "pose_topic": "/pose", "cache": str(tmp_path)}
    arguments = ros_arguments(LAUNCH_FILE, {**given, "apply": apply, "use_sim_time": "true"})
    with (
        slipwise_ros(ros_python, arguments),
        Peer(ros_python, "lifecycle_node.py", NODE, environment=ROS) as peer,
    ):
        assert peer.ask("state") == "active"
        kept = {"name": "husky-1", "pose_topic": "/pose", "live.apply.mode": mode, "use_sim_time": True}
        assert peer.ask("get", names=list(kept)) == kept


def test_the_layout_shows_topics_and_fields_that_there_are() -> None:
    layout = json.loads((ROOT / "ros/slipwise_ros/layouts/slipwise.json").read_text())
    text = json.dumps(layout)
    used = set(re.findall(r'"/slipwise/(\w+)((?:\.\w+)*)', text))
    assert {topic for topic, _ in used} == {"predicted_path", "odometry", "slip_state", "motion_model"}
    fields = ros_types().fielddefs
    for topic, path in used:
        kind = TOPICS[topic].type
        for field in path.split(".")[1:]:
            found = dict(fields[kind][1])[field]
            kind = found[1] if isinstance(found[1], str) else ""
    (row,) = re.findall(r"parameters\[:\]{(\w+)==true}", text)  # a filter on rows of the model
    assert row in dict(fields["slipwise_msgs/msg/Parameter"][1])
    panels = set(re.findall(r'"((?:3D|Plot|RawMessages)!\w+)"', json.dumps(layout["layout"])))
    assert panels == set(layout["configById"])


#: Keys that the panels read, by Lichtblick (`PlotConfig`, `PlotPath`, `RendererConfig`,
#: `RawMessages`); the layout may have some. An unknown one is ignored there, and nobody would see it.
PANEL_KEYS = {
    "3D": {"cameraState", "followMode", "followTf", "scene", "topics", "transforms", "layers"},
    "Plot": {"paths", "showLegend", "isSynced", "foxglovePanelTitle", "lichtblickPanelTitle"},
    "RawMessages": {"topicPath", "diffEnabled"},
}
PATH_KEYS = {"value", "enabled", "timestampMethod", "label", "color", "showLine", "lineSize"}


def test_the_layout_says_what_panels_read() -> None:
    layout = json.loads((ROOT / "ros/slipwise_ros/layouts/slipwise.json").read_text())
    for name, config in layout["configById"].items():
        assert config.keys() <= PANEL_KEYS[name.partition("!")[0]], name
        for path in config.get("paths", []):
            assert path.keys() <= PATH_KEYS
            assert path["timestampMethod"] in ("receiveTime", "headerStamp")
    view = layout["configById"]["3D!slipwise"]
    assert view["followMode"] in ("follow-pose", "follow-position", "follow-none")
    names = [topic.removeprefix("/slipwise/") for topic in view["topics"]]
    shown = {name: TOPICS[name].type for name in names}
    assert shown == {"predicted_path": "nav_msgs/msg/Path", "odometry": "nav_msgs/msg/Odometry"}
    assert {each["type"] for each in view["topics"].values()} == {"line", "arrow"}


def test_the_launch_file_gives_parameters_that_the_node_has() -> None:
    root = ET.parse(LAUNCH_FILE).getroot()
    arguments = {each.attrib["name"] for each in root.iter("arg")}
    (node,) = root.iter("node")
    assert (node.attrib["pkg"], node.attrib["exec"]) == ("slipwise_ros", "live")
    used = {each.attrib["value"].removeprefix("$(var ").removesuffix(")") for each in node.iter("param")}
    assert used | {"node", "namespace"} == arguments

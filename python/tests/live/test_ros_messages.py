# SPDX-License-Identifier: Apache-2.0
"""Outputs become ROS messages that rosbags, and rclpy, read back as they were."""

from __future__ import annotations

import json
import math
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from live.sample_outputs import (
    driven_outputs,
    next_moves,
    odometry_at,
    straight_path,
    surface_at,
    waiting_status,
)
from live.typed_model import assert_same_numbers

from slipwise.live.outputs import ModelText, Note, Output, Status
from slipwise.live.ros_messages import TOPICS, RosMessage, RosMessages, stamp_ns
from slipwise.models.model import parse_model

READ_WITH_RCLPY = """
import importlib, json, sys
from rclpy.serialization import deserialize_message, serialize_message
for line in sys.stdin:
    kind, payload = json.loads(line)
    package, _, name = kind.split("/")
    made = getattr(importlib.import_module(package + ".msg"), name)
    message = deserialize_message(bytes.fromhex(payload), made)
    print(json.dumps([kind, serialize_message(message).hex()]))
"""


@pytest.fixture
def messages() -> RosMessages:
    return RosMessages()


def _read(messages: RosMessages, message: RosMessage) -> Any:
    return messages.store.deserialize_cdr(message.payload, message.type)


def _of(messages: RosMessages, output: Output) -> dict[str, Any]:
    return {message.topic: _read(messages, message) for message in messages.of(output)}


def test_odometry_carries_pose_twist_and_covariances_of_the_plane(messages: RosMessages) -> None:
    now = odometry_at(12.25)
    read = _of(messages, now)
    whole, alone = read["odometry"], read["twist"]
    assert (whole.header.stamp.sec, whole.header.stamp.nanosec) == (12, 250_000_000)
    assert (whole.header.frame_id, whole.child_frame_id, alone.header.frame_id) == (
        "map",
        "base_link",
        "base_link",
    )
    position, turn = whole.pose.pose.position, whole.pose.pose.orientation
    assert (position.x, position.y) == (1.0, 2.0)
    assert 2.0 * math.atan2(turn.z, turn.w) == pytest.approx(0.5)
    plane = np.ix_([0, 1, 5], [0, 1, 5])
    assert whole.pose.covariance.reshape(6, 6)[plane] == pytest.approx(now.pose_covariance)
    assert whole.pose.covariance.reshape(6, 6)[2:5].any() == 0
    for twist in (whole.twist, alone.twist):
        assert (twist.twist.linear.x, twist.twist.linear.y, twist.twist.angular.z) == (0.9, -0.01, 0.3)
        assert twist.covariance.reshape(6, 6)[plane] == pytest.approx(now.twist_covariance)


def test_an_answer_is_a_path_and_one_with_its_covariance(messages: RosMessages) -> None:
    path = straight_path(asked=True)
    path.covariance[1, 0, 0] = np.inf
    read = _of(messages, path)
    assert set(read) == {"prediction", "prediction_with_covariance"}
    assert [pose.pose.position.x for pose in read["prediction"].poses] == [0.0, 1.0, 2.0, 3.0]
    whole = read["prediction_with_covariance"]
    assert whole.path.poses == read["prediction"].poses
    assert whole.covariance.tolist() == path.covariance.ravel().tolist()
    assert set(_of(messages, straight_path())) == {"predicted_path"}


def test_the_model_and_the_surface_are_kept_for_who_comes_late(messages: RosMessages) -> None:
    latched = {"model", "surface", "surfaces", "next_moves", "motion_model", "slip_state"}
    assert {name for name, topic in TOPICS.items() if topic.latched} == latched
    (message,) = messages.of(ModelText(1.0, "schema: 4\nname: Ä\n"))
    assert message.latched
    assert _read(messages, message).data == "schema: 4\nname: Ä\n"


def test_the_typed_model_has_every_number_of_the_model_file(messages: RosMessages) -> None:
    said = next(output for output in driven_outputs() if isinstance(output, ModelText))
    read = _of(messages, said)["motion_model"]
    wanted = parse_model(said.text, where="the topic").content
    assert (read.vehicle, read.validity, read.given) == ("Husky 7", read.ESTIMATED, "valid")
    assert wanted.slip_disturbance is not None
    assert_same_numbers(read, wanted)


def test_the_slip_state_is_sent_where_it_has_changed() -> None:
    messages = RosMessages()
    now = next(output for output in reversed(driven_outputs()) if isinstance(output, Status))
    sent = [messages.of(each, lambda _topic: False) for each in (now, replace(now, t=now.t + 1.0))]
    ((state,), none) = sent
    assert (state.topic, none) == ("slip_state", [])
    read = _read(messages, state)
    assert now.slip is not None
    assert now.odometry is not None
    assert read.slip.tolist() == now.slip.tolist()
    assert read.covariance.tolist() == now.odometry.twist_covariance.ravel().tolist()
    (other,) = messages.of(replace(now, state="stuck"), lambda _topic: False)
    assert _read(messages, other).state == "stuck"


def test_moves_worth_driving_have_a_bar_per_prediction_and_parameter(messages: RosMessages) -> None:
    read = _of(messages, next_moves())["next_moves"]
    move = read.moves[0]
    assert (move.v, move.omega, move.seconds, move.teaches) == (1.0, -0.8, 2.0, "ang.V*w")
    assert (move.yaw_standard_deviation, move.position_standard_deviation) == (0.12, 0.2)
    known = {each.name: each.known for each in (*read.predictions, *read.parameters)}
    assert known["position"] == known["ang.w"] == 1.0
    assert 0.0 < known["yaw"] < 1.0
    assert read.reason == ""


def test_the_name_of_a_surface_is_sent_where_it_is_another_and_the_rest_each_time() -> None:
    messages = RosMessages()
    sent = [messages.of(surface_at(name=name)) for name in ("sand", "sand", "")]
    assert [[message.topic for message in each] for each in sent] == [
        ["surface", "surfaces"],
        ["surfaces"],
        ["surface", "surfaces"],
    ]
    assert [_read(messages, each[0]).data for each in (sent[0], sent[2])] == ["sand", ""]
    whole = _read(messages, sent[0][1])
    assert (whole.names, whole.probabilities.tolist()) == (["sand", ""], pytest.approx([0.9, 0.1]))
    assert [(each.name, each.visits) for each in whole.remembered] == [("hall", 2)]
    assert (whole.labels_judged, whole.labels_right) == (3.0, 2.0)


def test_every_output_of_a_drive_is_read_back_to_the_same_bytes(messages: RosMessages) -> None:
    used = set()
    for output in (*driven_outputs(), next_moves()):
        for message in messages.of(output):
            used.add(message.topic)
            again = messages.store.serialize_cdr(_read(messages, message), message.type)
            assert bytes(again) == message.payload
    assert used == set(TOPICS) - {"prediction", "prediction_with_covariance"}


def test_hostile_strings_and_numbers_make_valid_messages(messages: RosMessages) -> None:
    status = waiting_status(vehicle="a\0b\udc80 'ü'", why="\ud800", t=math.nan)
    (message, _) = messages.of(status)
    read = _read(messages, message)
    assert read.status[0].hardware_id == "a�b? 'ü'"
    (note,) = messages.of(Note(-1e30, "x\0"))
    assert _read(messages, note).status[0].message == "x�"
    nowhere = replace(odometry_at(math.inf), pose=np.full(3, np.nan))
    assert math.isnan(_of(messages, nowhere)["odometry"].pose.pose.orientation.w)


def test_stamps_keep_their_nanoseconds_and_stay_within_a_header() -> None:
    assert stamp_ns(1_700_000_000.123456) == pytest.approx(1_700_000_000_123_456_000, abs=200)
    assert stamp_ns(0.1) == 100_000_000
    assert [stamp_ns(t) for t in (-1.0, math.nan, 1e30)] == [0, 0, (2**31 - 1) * 1_000_000_000]


@pytest.mark.slow
def test_rclpy_reads_every_message_and_writes_the_same_bytes(messages: RosMessages, ros_python: Path) -> None:
    outputs = [*driven_outputs()[-60:], straight_path(asked=True), next_moves(), Note(1.0, "said: Ä")]
    sent = [message for output in outputs for message in messages.of(output)]
    assert {message.topic for message in sent} == set(TOPICS)
    lines = "".join(json.dumps([m.type, m.payload.hex()]) + "\n" for m in sent)
    ran = subprocess.run(
        [str(ros_python), "-c", READ_WITH_RCLPY], input=lines, capture_output=True, text=True, check=True
    )
    answers = [json.loads(line) for line in ran.stdout.splitlines()]
    assert len(answers) == len(sent)
    for message, (kind, payload) in zip(sent, answers, strict=True):
        written = bytes.fromhex(payload)[: len(message.payload) + 3]  # Fast CDR may add zeros behind
        again = messages.store.deserialize_cdr(written, kind)
        assert bytes(messages.store.serialize_cdr(again, kind)) == message.payload

# SPDX-License-Identifier: Apache-2.0
"""Which topics of a robot are sources of poses, and whether an IMU gives headings or yaw rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.live.first_messages import FirstMessages
from slipwise.live.ros_roles import (
    first_poses,
    only_positions,
    source_topics,
    uses_of,
    with_oriented_imu,
)
from slipwise.live.ros_samples import FirstPoses
from slipwise.live.ros_transport import CueTopics, RosTransport
from slipwise.live.samples import Pose, Reading, Sample
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import OnMessage, WireTopic
from slipwise.logs.messages import IMU, NAV_SAT_FIX, POSE_STAMPED
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import Topic
from slipwise.logs.topics import Roles

NOW = 1e9  # s
STORE = ros_types()
FIX, LIDAR, GYRO = Topic("/fix", NAV_SAT_FIX, 1), Topic("/lidar", POSE_STAMPED, 1), Topic("/imu", IMU, 1)


class Wire:
    """Hands messages over as soon as somebody subscribes."""

    name = "a test's"

    def __init__(self, messages: dict[str, list[bytes]]) -> None:
        self.messages = messages

    def topics(self) -> list[WireTopic]:
        return []

    def subscribe(self, topic: str, _type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        del latched
        for message in self.messages.get(topic, []):
            on_message(message, NOW)

    def publish(self, _topic: str, _type_name: str, _payload: bytes, *, latched: bool = False) -> None:
        del latched

    def advertise(self, _topic: str, _type_name: str, *, latched: bool = False) -> None:
        del latched

    def call(self, _service: str, _type_name: str, _request: bytes, *, timeout: float) -> bytes | None:
        del timeout
        return None

    def connections(self, _topic: str) -> int:
        return 0

    def notices(self) -> list[str]:
        return []

    def close(self) -> None:
        pass


def made(kind: str, *values: object) -> object:
    return STORE.types[kind](*values)


def header() -> object:
    return made("std_msgs/msg/Header", made("builtin_interfaces/msg/Time", 12, 0), "map")


def imu(*, oriented: bool, roll: float = 0.0) -> bytes:
    x, w = (np.sin(roll / 2.0), np.cos(roll / 2.0)) if oriented else (0.0, 0.0)
    q = made("geometry_msgs/msg/Quaternion", x, 0.0, 0.0, w)
    rate, none = made("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.3), np.zeros(9)
    return bytes(STORE.serialize_cdr(made(IMU, header(), q, none, rate, none, rate, none), IMU))


def fix(status: int) -> bytes:
    said = made("sensor_msgs/msg/NavSatStatus", status, 1)
    message = made(NAV_SAT_FIX, header(), said, 48.0, 9.0, 300.0, np.zeros(9), 0)
    return bytes(STORE.serialize_cdr(message, NAV_SAT_FIX))


def roles(
    pose: Topic | None, *, others: tuple[Topic, ...] = (), headed: bool = False, gyro: bool = False
) -> Roles:
    return Roles(
        pose,
        None,
        Topic("/odom", "none", 1),
        GYRO if headed else None,
        (),
        {},
        others,
        GYRO if gyro else None,
    )


def topics_of(taken: Roles) -> list[Topic]:
    return [topic for _, topic in uses_of(taken)]


@pytest.mark.parametrize("oriented", [True, False])
def test_an_imu_without_an_orientation_gives_no_headings(oriented: bool) -> None:
    said: list[str] = []
    wire = Wire({"/imu": [imu(oriented=oriented)] * 3})
    chosen = roles(FIX, headed=True, gyro=True)
    found = with_oriented_imu(FirstMessages(wire, topics_of(chosen)), chosen, said.append)
    assert only_positions(found) is not oriented
    assert found.gyro == GYRO
    assert said == ([] if oriented else ["/imu has no orientation: its yaw rates are used"])


def lidar(w: float, qx: float = 0.0, qy: float = 0.0) -> bytes:
    q, at = (
        made("geometry_msgs/msg/Quaternion", qx, qy, 0.0, w),
        made("geometry_msgs/msg/Point", 1.0, 2.0, 0.0),
    )
    message = made(POSE_STAMPED, header(), made("geometry_msgs/msg/Pose", at, q))
    return bytes(STORE.serialize_cdr(message, POSE_STAMPED))


@pytest.mark.parametrize("w", [0.0, 1.0])
def test_poses_without_rotations_are_positions_as_calibrate_takes_them(w: float) -> None:
    said: list[str] = []
    wire = Wire({"/lidar": [lidar(w)] * 3})
    first = FirstMessages(wire, topics_of(roles(LIDAR)))
    seen = first_poses(first, roles(LIDAR), said.append)
    positions, attitude, _ = seen
    assert positions is (w == 0.0)
    assert not attitude
    assert said == (["the quaternions of /lidar are no rotations: positions only"] if positions else [])
    transport = RosTransport(wire, roles(LIDAR), LogOptions(), name="slipwise", seen=seen, first=first)
    found: list[Sample] = []
    transport.subscribe(found.append)
    poses = [pose for pose in found if isinstance(pose, Pose)]
    assert [(pose.x, pose.y) for pose in poses] == [(1.0, 2.0)] * 3
    assert all(np.isnan(pose.yaw) is np.bool_(positions) for pose in poses)


def test_poses_with_a_roll_and_a_pitch_are_learned_from_with_terms_of_gravity() -> None:
    def seen(chosen: Roles, messages: dict[str, list[bytes]]) -> FirstPoses:
        return first_poses(FirstMessages(Wire(messages), topics_of(chosen)), chosen, print)

    tilted = [lidar(1.0), lidar(0.8, 0.48, 0.36), lidar(1.0)]
    assert seen(roles(LIDAR), {"/lidar": tilted}) == FirstPoses(attitude=True, tilts=True)
    rolled = [lidar(1.0), lidar(0.96, 0.28), lidar(1.0)]
    assert seen(roles(LIDAR), {"/lidar": rolled}) == FirstPoses()
    beside = {"/lidar": [lidar(1.0)] * 3, "/imu": [imu(oriented=True, roll=0.1)] * 3}
    assert seen(roles(LIDAR, headed=True), beside) == FirstPoses(attitude=True)
    fixes = roles(FIX, headed=True)
    level, none = (seen(fixes, {"/imu": [imu(oriented=oriented)] * 3}) for oriented in (True, False))
    assert level == none


def test_what_came_before_it_was_known_how_it_is_read_is_learned_from_in_order() -> None:
    wire = Wire({})
    takers: dict[str, OnMessage] = {}
    wire.subscribe = lambda topic, _kind, take, *, latched=False: takers.setdefault(topic, take)  # type: ignore[method-assign]
    chosen = roles(LIDAR, others=(Topic("/mocap", POSE_STAMPED, 1),))
    chosen = replace(chosen, wheel=None)
    first = FirstMessages(wire, topics_of(chosen))
    for topic in ("/mocap", "/lidar", "/mocap"):
        takers[topic](lidar(1.0), NOW)
    found: list[Sample] = []
    transport = RosTransport(wire, chosen, LogOptions(), name="slipwise", first=first)
    transport.subscribe(found.append)
    takers["/lidar"](lidar(1.0), NOW)
    assert [sample.source for sample in found if isinstance(sample, Pose)] == ["/mocap", "", "/mocap", ""]


def samples_of(taken: Roles, messages: dict[str, list[bytes]]) -> list[Sample]:
    taken = Roles(taken.pose, None, None, taken.imu, (), {}, taken.others, taken.gyro)
    transport = RosTransport(Wire(messages), taken, LogOptions(), name="slipwise", cues=CueTopics())
    found: list[Sample] = []
    transport.subscribe(found.append)
    return [sample for sample in found if isinstance(sample, Pose | Reading)]


def test_yaw_rates_come_beside_positions_and_alone() -> None:
    beside = samples_of(roles(FIX, gyro=True), {"/fix": [fix(0)], "/imu": [imu(oriented=False)]})
    assert len(beside) == 2
    assert Reading(12.0, "gyro_z", 0.3) in beside
    assert samples_of(roles(None, gyro=True), {"/imu": [imu(oriented=True)]}) == [
        Reading(12.0, "gyro_z", 0.3)
    ]


def test_poses_of_further_topics_say_whose_they_are() -> None:
    chosen = roles(LIDAR, others=(FIX,))
    assert source_topics(chosen) == ("/lidar", "/fix")
    assert source_topics(roles(LIDAR)) == ()
    (pose,) = samples_of(chosen, {"/fix": [fix(2)]})
    assert isinstance(pose, Pose)
    assert (pose.source, pose.fix) == ("/fix", "rtk_fixed")
    assert np.isnan(pose.yaw)

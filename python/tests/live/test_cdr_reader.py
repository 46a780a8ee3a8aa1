# SPDX-License-Identifier: Apache-2.0
"""What is read at its place in the bytes is what decoding in full gives."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from slipwise.live.cdr_reader import reader_of
from slipwise.live.wires.ros_types import ros_types
from slipwise.logs.messages import (
    COMMAND_VALUES,
    IMU,
    IMU_VALUES,
    ODOMETRY,
    POSE_STAMPED,
    POSE_VALUES,
    POSE_WITH_COVARIANCE,
    TWIST,
    TWIST_STAMPED,
    WHEEL_VALUES,
)

STORE = ros_types()
FRAMES = ("", "m", "map", "base_link", "odom/ü", "a" * 200)
KINDS = (TWIST, TWIST_STAMPED, POSE_STAMPED, POSE_WITH_COVARIANCE, ODOMETRY)


def made(kind: str, number: Callable[[], float], frame: str) -> Any:
    """A message of a type, each of whose numbers is another one."""
    t: dict[str, Any] = dict(STORE.types)
    stamp = t["builtin_interfaces/msg/Time"](random.randrange(-(2**31), 2**31), random.randrange(10**9))
    header = t["std_msgs/msg/Header"](stamp, frame)

    def vector() -> Any:
        return t["geometry_msgs/msg/Vector3"](number(), number(), number())

    def twist() -> Any:
        return t[TWIST](vector(), vector())

    def pose() -> Any:
        point = t["geometry_msgs/msg/Point"](number(), number(), number())
        q = t["geometry_msgs/msg/Quaternion"](number(), number(), number(), number())
        return t["geometry_msgs/msg/Pose"](point, q)

    def with_covariance(name: str, what: Any) -> Any:
        return t[f"geometry_msgs/msg/{name}WithCovariance"](what, np.array([number() for _ in range(36)]))

    match kind:
        case "geometry_msgs/msg/Twist":
            return twist()
        case "geometry_msgs/msg/TwistStamped":
            return t[kind](header, twist())
        case "geometry_msgs/msg/PoseStamped":
            return t[kind](header, pose())
        case "geometry_msgs/msg/PoseWithCovarianceStamped":
            return t[kind](header, with_covariance("Pose", pose()))
        case _:
            child = random.choice(FRAMES)
            uncertain = with_covariance("Pose", pose()), with_covariance("Twist", twist())
            return t[kind](header, child, *uncertain)


def taken(kind: str, message: Any) -> tuple[Any, ...]:
    """All that is taken out of a message."""
    values = [table[kind](message) for table in (COMMAND_VALUES, POSE_VALUES, WHEEL_VALUES) if kind in table]
    header = getattr(message, "header", None)
    stamped = () if header is None else (header.stamp.sec, header.stamp.nanosec, header.frame_id)
    return (*values, *stamped)


def test_the_same_is_taken_out_of_a_message_as_from_one_decoded_in_full(subtests: pytest.Subtests) -> None:
    for kind in KINDS:
        for little_endian in [True, False]:
            with subtests.test(kind=kind, little_endian=little_endian):
                random.seed(4)
                read = reader_of(kind, STORE)
                for frame in FRAMES:
                    message = made(kind, lambda: random.gauss(0.0, 1e3), frame)
                    payload = bytes(STORE.serialize_cdr(message, kind, little_endian=little_endian))
                    assert taken(kind, read(payload)) == taken(kind, STORE.deserialize_cdr(payload, kind))
                    assert taken(kind, read(payload)) == taken(kind, message)


def test_numbers_that_are_none_are_read_as_such(subtests: pytest.Subtests) -> None:
    for kind in KINDS:
        with subtests.test(kind=kind):
            payload = bytes(STORE.serialize_cdr(made(kind, lambda: math.nan, "map"), kind))
            values, *_ = taken(kind, reader_of(kind, STORE)(payload))
            assert all(map(math.isnan, values))


def test_bytes_that_end_early_or_lie_about_a_length_are_refused(subtests: pytest.Subtests) -> None:
    for kind in KINDS:
        with subtests.test(kind=kind):
            read = reader_of(kind, STORE)
            payload = bytes(STORE.serialize_cdr(made(kind, lambda: 1.0, "map"), kind))
            for length in (0, 1, 4, 9, 20, len(payload) // 2, len(payload) - 1):
                with pytest.raises(Exception):  # noqa: B017, PT011 (whichever: the transport says it and goes on)
                    read(payload[:length])
            if kind != TWIST:
                with pytest.raises(Exception):  # noqa: B017, PT011
                    read(payload[:12] + b"\xff\xff\xff\xff" + payload[16:])


def test_other_types_are_decoded_in_full() -> None:
    t: dict[str, Any] = dict(STORE.types)
    header = t["std_msgs/msg/Header"](t["builtin_interfaces/msg/Time"](1, 2), "imu")
    q = t["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.6, 0.8)
    v = t["geometry_msgs/msg/Vector3"](1.0, 2.0, 3.0)
    message = t[IMU](header, q, np.zeros(9), v, np.zeros(9), v, np.zeros(9))
    payload = bytes(STORE.serialize_cdr(message, IMU))
    found = reader_of(IMU, STORE)(payload)
    assert IMU_VALUES[IMU](found) == (0.0, 0.0, 0.6, 0.8)
    assert found.header == header

# SPDX-License-Identifier: Apache-2.0
"""Schemas stand for ROS types, and their messages take the shape of these."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from slipwise.logs.foxglove_messages import as_ros, from_json, ros_type


def test_schemas_stand_for_ros_types(subtests: pytest.Subtests) -> None:
    for schema, expected in [
        ("foxglove.PoseInFrame", "geometry_msgs/msg/PoseStamped"),
        ("foxglove.FrameTransform", "tf2_msgs/msg/TFMessage"),
        ("nav_msgs/Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs/msg/Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msgs.msg.Odometry", "nav_msgs/msg/Odometry"),
        ("foxglove.CompressedImage", "foxglove.CompressedImage"),
        ("mine", "mine"),
        ("", ""),
    ]:
        with subtests.test(schema=schema, expected=expected):
            assert ros_type(schema) == expected


def test_a_fix_has_position_covariance_and_stamp() -> None:
    fix = as_ros(
        "foxglove.LocationFix",
        SimpleNamespace(
            timestamp=SimpleNamespace(seconds=5, nanos=7),
            frame_id="gps",
            latitude=45.0,
            longitude=7.0,
            altitude=1.0,
            position_covariance=[1.0],
            position_covariance_type=2,
        ),
    )
    assert (fix.header.stamp.sec, fix.header.stamp.nanosec, fix.header.frame_id) == (5, 7, "gps")
    assert (fix.latitude, fix.longitude, fix.status.status) == (45.0, 7.0, 0)
    assert fix.position_covariance == [1.0, *([0.0] * 8)]


def test_one_transform_is_a_message_of_one() -> None:
    content = {
        "timestamp": {"sec": 1, "nsec": 2},
        "parent_frame_id": "map",
        "child_frame_id": "base_link",
        "translation": {"x": 1.0, "y": 2.0, "z": 3.0},
        "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    }
    (transform,) = as_ros("foxglove.FrameTransform", from_json(json.dumps(content).encode())).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("map", "base_link")
    assert transform.transform.translation.y == 2.0


def test_stamps_of_json_may_have_the_names_of_ros_1() -> None:
    message = as_ros("sensor_msgs/Imu", from_json(b'{"header": {"stamp": {"secs": 3, "nsecs": 4}}}'))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (3, 4)


def test_what_lacks_a_field_or_is_no_object_is_an_error() -> None:
    with pytest.raises(AttributeError):
        as_ros("foxglove.PoseInFrame", SimpleNamespace(frame_id="map"))
    with pytest.raises(ValueError, match="not a JSON object"):
        from_json(b"[1, 2]")

# SPDX-License-Identifier: Apache-2.0
"""Foxglove's schemas, and ROS messages as JSON or protobuf, in the shape of ROS messages."""

from __future__ import annotations

import json
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from slipwise.logs.messages import (
    COMMAND_TYPES,
    IMU,
    JOINT_STATE,
    NAV_SAT_FIX,
    POSE_STAMPED,
    POSE_TYPES,
    TF,
    WHEEL_TYPES,
)

#: What Foxglove's schemas stand for; those that say nothing about a robot's motion are left out.
FOXGLOVE_TYPES = {
    "foxglove.FrameTransform": TF,
    "foxglove.FrameTransforms": TF,
    "foxglove.LocationFix": NAV_SAT_FIX,
    "foxglove.PoseInFrame": POSE_STAMPED,
}
_ROS_TYPES = {*COMMAND_TYPES, *POSE_TYPES, *WHEEL_TYPES, IMU, JOINT_STATE, "std_msgs/msg/String"}
_SECONDS, _NANOSECONDS = ("sec", "seconds", "secs"), ("nanosec", "nsec", "nanos", "nsecs")


def ros_type(schema: str) -> str:
    """Return the ROS type that a schema stands for, such as "nav_msgs/msg/Odometry"; else its own name."""
    if schema in FOXGLOVE_TYPES:
        return FOXGLOVE_TYPES[schema]
    parts = schema.replace(".", "/").split("/")
    name = f"{parts[0]}/msg/{parts[-1]}"
    return name if len(parts) > 1 and name in _ROS_TYPES else schema


def from_json(data: bytes) -> Any:
    """Return a JSON object whose keys are attributes.

    Raises:
        ValueError: it is none.
    """
    content = json.loads(data, object_hook=lambda keys: SimpleNamespace(**keys))
    if not isinstance(content, SimpleNamespace):
        raise ValueError("not a JSON object")
    return content


def as_ros(schema: str, message: Any) -> Any:
    """Return a decoded message in the shape of the ROS message that its schema stands for.

    Args:
        schema: name of the schema.
        message: an object with its fields as attributes.

    Raises:
        AttributeError: a field is missing.
    """
    make = _MADE.get(schema)
    if make is not None:
        return make(message)
    if isinstance(message, SimpleNamespace):
        _with_ros_stamp(message)
    return message


def _stamp(time: Any) -> SimpleNamespace:
    return SimpleNamespace(sec=int(_any(time, _SECONDS)), nanosec=int(_any(time, _NANOSECONDS)))


def _any(owner: Any, names: tuple[str, ...]) -> Any:
    for name in names:
        found = getattr(owner, name, None)
        if found is not None:
            return found
    raise AttributeError(f"no {names[0]}")


def _with_ros_stamp(message: SimpleNamespace) -> None:
    """Give a header's stamp, and those of transforms, the names that ROS 2 has for its parts."""
    for part in (message, *vars(message).get("transforms", ())):
        header = vars(part).get("header")
        if header is not None:
            header.stamp = _stamp(header.stamp)


def _header(message: Any, frame: str) -> SimpleNamespace:
    return SimpleNamespace(stamp=_stamp(message.timestamp), frame_id=frame)


def _pose(message: Any) -> SimpleNamespace:
    return SimpleNamespace(header=_header(message, message.frame_id), pose=message.pose)


def _fix(message: Any) -> SimpleNamespace:
    return SimpleNamespace(
        header=_header(message, message.frame_id),
        latitude=message.latitude,
        longitude=message.longitude,
        altitude=message.altitude,
        status=SimpleNamespace(status=0),
        position_covariance=[*message.position_covariance, *(9 * [0.0])][:9],
        position_covariance_type=message.position_covariance_type,
    )


def _transform(message: Any) -> SimpleNamespace:
    return SimpleNamespace(
        header=_header(message, message.parent_frame_id),
        child_frame_id=message.child_frame_id,
        transform=SimpleNamespace(translation=message.translation, rotation=message.rotation),
    )


_MADE: dict[str, Callable[[Any], Any]] = {
    "foxglove.FrameTransform": lambda message: SimpleNamespace(transforms=[_transform(message)]),
    "foxglove.FrameTransforms": lambda message: SimpleNamespace(
        transforms=[_transform(each) for each in message.transforms]
    ),
    "foxglove.LocationFix": _fix,
    "foxglove.PoseInFrame": _pose,
}

# SPDX-License-Identifier: Apache-2.0
"""Messages as bytes, and waiting for them, for the tests of the wires."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from slipwise.live.wires.ros_types import ros_types

TWIST = "geometry_msgs/msg/TwistStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
STRING = "std_msgs/msg/String"


def to_cdr(type_name: str, **fields: object) -> bytes:
    """Return a message as bytes."""
    return bytes(ros_types().serialize_cdr(ros_types().types[type_name](**fields), type_name))


def from_cdr(type_name: str, message: bytes) -> Any:
    """Return a message read from bytes."""
    return ros_types().deserialize_cdr(message, type_name)


def command(number: int) -> bytes:
    """Return a command that was stamped now and drives with that many m/s."""
    types = ros_types().types
    seconds, rest = divmod(time.time_ns(), 1_000_000_000)
    stamp = types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=rest)
    vector = types["geometry_msgs/msg/Vector3"]
    return to_cdr(
        TWIST,
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id="base_link"),
        twist=types["geometry_msgs/msg/Twist"](
            linear=vector(x=float(number), y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=0.5)
        ),
    )


def set_parameter(name: str, number: float) -> bytes:
    """Return the request to set a parameter of a node to a number."""
    types = ros_types().types
    nothing = np.zeros(0)
    value = types["rcl_interfaces/msg/ParameterValue"](
        type=3,
        bool_value=False,
        integer_value=0,
        double_value=number,
        string_value="",
        byte_array_value=nothing.astype(np.uint8),
        bool_array_value=nothing.astype(np.bool_),
        integer_array_value=nothing.astype(np.int64),
        double_array_value=nothing,
        string_array_value=[],
    )
    parameter = types["rcl_interfaces/msg/Parameter"](name=name, value=value)
    return to_cdr("rcl_interfaces/srv/SetParameters_Request", parameters=[parameter])


def wait_until(condition: Callable[[], object], seconds: float = 10.0) -> bool:
    """Return whether something becomes true in time."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.01)
    return bool(condition())

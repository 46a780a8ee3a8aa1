# SPDX-License-Identifier: Apache-2.0
"""Classes for Cyclone DDS serialize to the bytes that ROS has."""

from __future__ import annotations

import pytest
from live.wires.wire_messages import TWIST, command, set_parameter

from slipwise.errors import SettingsError
from slipwise.live.wires.cyclone_types import cyclone_type

pytest.importorskip("cyclonedds")


@pytest.mark.parametrize(
    ("name", "message"),
    [(TWIST, command(3)), ("rcl_interfaces/srv/SetParameters_Request", set_parameter("gain", 2.5))],
    ids=["a command", "parameters"],
)
def test_bytes_are_read_and_written_as_ros_has_them(name: str, message: bytes) -> None:
    kind = cyclone_type(name)
    assert kind.deserialize(message).serialize()[4:] == message[4:]


def test_arrays_sequences_and_bounded_strings_have_their_lengths() -> None:
    described = {
        name: repr(kind)
        for name in (
            "nav_msgs/msg/Odometry",
            "geometry_msgs/msg/PoseWithCovariance",
            "rmw_dds_common/msg/NodeEntitiesInfo",
        )
        for kind in [cyclone_type(name).__annotations__]
    }
    assert "float64, 36" in described["geometry_msgs/msg/PoseWithCovariance"].replace("'", "")
    assert "256" in described["rmw_dds_common/msg/NodeEntitiesInfo"]


def test_an_empty_message_has_a_member() -> None:
    assert list(cyclone_type("std_msgs/msg/Empty").__annotations__) == ["structure_needs_at_least_one_member"]


def test_a_numbered_request_begins_with_who_asks() -> None:
    kind = cyclone_type("std_srvs/srv/Trigger_Request", numbered=True)
    assert list(kind.__annotations__)[:2] == ["client", "number"]
    assert kind.__idl_typename__ == "std_srvs.srv.dds_.Trigger_Request_"


def test_an_unknown_type_is_refused() -> None:
    with pytest.raises(SettingsError, match="no message type"):
        cyclone_type("nav_msgs/msg/Odometer")

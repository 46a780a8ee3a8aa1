# SPDX-License-Identifier: Apache-2.0
"""Types have the names and hashes that ROS 2 Jazzy gives them."""

from __future__ import annotations

import pytest

from slipwise.errors import SettingsError
from slipwise.live.wires.ros_types import dds_type, require_type, ros_type, ros_types, type_hash


@pytest.mark.parametrize(
    ("name", "digits"),
    [  # from the JSON files of ros-jazzy-*
        ("nav_msgs/msg/Odometry", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"),
        (
            "geometry_msgs/msg/TwistStamped",
            "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
        ),
        (
            "rcl_interfaces/srv/SetParameters",
            "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
        ),
        ("std_srvs/srv/Trigger", "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"),
    ],
)
def test_hashes_are_those_of_jazzy(name: str, digits: str) -> None:
    assert type_hash(name) == f"RIHS01_{digits}"


def test_names_on_the_wire_and_back() -> None:
    assert dds_type("nav_msgs/msg/Odometry") == "nav_msgs::msg::dds_::Odometry_"
    assert ros_type("nav_msgs::msg::dds_::Odometry_") == "nav_msgs/msg/Odometry"
    assert ros_type("MyType") == "MyType"


def test_an_unknown_type_is_refused_with_an_example() -> None:
    with pytest.raises(SettingsError, match=r'no message type "nav_msgs/Odometry".*"nav_msgs/msg/Odometry"'):
        require_type("nav_msgs/Odometry")


def test_an_empty_request_has_the_byte_that_ros_gives_it() -> None:
    request = ros_types().types["std_srvs/srv/Trigger_Request"]()
    assert bytes(ros_types().serialize_cdr(request, "std_srvs/srv/Trigger_Request")) == b"\0\1\0\0\0"

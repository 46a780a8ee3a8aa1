# SPDX-License-Identifier: Apache-2.0
"""Keys, tokens and attachments are those of rmw_zenoh."""

from __future__ import annotations

import struct

from slipwise.live.wires.ros_types import type_hash
from slipwise.live.wires.zenoh_graph import Endpoint, NodeTokens, attachment, data_key, gid_of, read_token

TWIST = "geometry_msgs/msg/TwistStamped"
NODE = NodeTokens(domain=3, session="ab12", node="slipwise", namespace="/robot")


def test_keys_hold_domain_topic_type_and_hash() -> None:
    start = "3/robot/cmd_vel/geometry_msgs::msg::dds_::TwistStamped_/"
    assert data_key(3, "/robot/cmd_vel", TWIST) == start + type_hash(TWIST)
    assert data_key(3, "/robot/cmd_vel", TWIST, any_hash=True) == start + "*"


def test_tokens_hold_names_without_slashes_and_the_quality_of_service() -> None:
    assert NODE.of_node() == "@ros2_lv/3/ab12/0/0/NN/%/%robot/slipwise"
    token = NODE.of_endpoint(4, "/robot/cmd_vel", TWIST, publishes=True, latched=False)
    start = "@ros2_lv/3/ab12/0/4/MP/%/%robot/slipwise/%robot%cmd_vel/geometry_msgs::msg::dds_::TwistStamped_/"
    assert token == f"{start}{type_hash(TWIST)}/::,10:,:,:,,"
    latched = NODE.of_endpoint(5, "/model", "std_msgs/msg/String", publishes=False, latched=True)
    assert latched.split("/")[5] == "MS"
    assert latched.endswith("/:1:,1:,:,:,,")


def test_a_token_is_read_as_it_was_written() -> None:
    token = NODE.of_endpoint(4, "/robot/cmd_vel", TWIST, publishes=True, latched=False)
    assert read_token(token) == Endpoint("ab12", True, "slipwise", "/robot/cmd_vel", TWIST)
    assert read_token(NODE.of_node()) is None
    assert read_token("something/else") is None
    assert read_token(token.replace("/MP/", "/SS/")) is None


def test_an_attachment_has_number_time_and_publisher_in_33_bytes() -> None:
    gid = gid_of("token")
    made = attachment(7, gid)
    number, nanoseconds, length = struct.unpack_from("<qqB", made)
    assert (len(made), number, length, made[17:]) == (33, 7, 16, gid)
    assert nanoseconds > 1_600_000_000 * 10**9
    assert gid_of("token") != gid_of("another")

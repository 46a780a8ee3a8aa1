# SPDX-License-Identifier: Apache-2.0
"""Finds a robot on ROS: which topics are what, and what will come on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from slipwise.calibration.coming import Coming
from slipwise.calibration.live_table import LiveTable
from slipwise.live.first_messages import FirstMessages
from slipwise.live.ros_roles import (
    find_roles,
    first_poses,
    only_positions,
    source_topics,
    uses_of,
    with_oriented_imu,
)
from slipwise.live.ros_samples import FirstPoses
from slipwise.live.ros_transport import CueTopics, RosTransport
from slipwise.live.wires.wire import RosWire
from slipwise.logs.options import LogOptions
from slipwise.logs.unheeded import ROS, refuse_unheeded


@dataclass(frozen=True)
class RosRobot:
    """A robot whose topics were found."""

    transport: RosTransport
    input_name: str
    coming: Coming


def find_robot(  # noqa: PLR0913 (where it is, and what is known of it)
    wire: RosWire,
    table: LiveTable,
    options: LogOptions,
    say: Callable[[str], None],
    *,
    name: str,
    simulated: bool | None = None,
) -> RosRobot:
    """Wait for a robot; where it cannot be used, the wire is closed.

    Args:
        wire: carries the messages.
        table: the settings of [live].
        options: topics, scales and sizes.
        say: called with what was found.
        name: of the node with its namespace, such as "robot_1/slipwise".
        simulated: whether /clock gives the time; None: where somebody publishes it.

    Raises:
        SlipwiseError: the topics cannot be used, or the wire was closed meanwhile.
    """
    try:
        refuse_unheeded(options, ROS)
        roles = find_roles(wire, options, say, own=f"/{name}")
        first = FirstMessages(wire, [topic for _, topic in uses_of(roles)])
        roles = with_oriented_imu(first, roles, say)
        for note in roles.guessed:
            say(str(note))
        input_name = table.input or ("command" if roles.command is not None else "wheel")
        say(f"learning from {input_name}s; the node is /{name}")
        if only_positions(roles):
            say("satellite fixes without an IMU: positions only, headings are the direction of the path")
        seen = first_poses(first, roles, say)
        positions = only_positions(roles) or table.positions or seen.positions
        tilts = seen.tilts or (table.attitude and roles.imu is None)
        seen = FirstPoses(positions, seen.attitude or table.attitude, tilts)
        cues = CueTopics(table.override_topic, table.surface_topic)
        transport = RosTransport(
            wire,
            roles,
            options,
            name=name,
            cues=cues,
            seen=seen,
            simulated=simulated,
            first=first,
        )
    except BaseException:
        wire.close()
        raise
    coming = Coming(
        positions=seen.positions,
        gyro_alone=roles.pose is None,
        sources=source_topics(roles),
        attitude=seen.attitude,
        sideways=options.sideways,
    )
    return RosRobot(transport, input_name, coming)

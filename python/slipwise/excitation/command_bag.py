# SPDX-License-Identifier: Apache-2.0
"""A drive as a bag that `ros2 bag play` sends to the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from slipwise.excitation.command_table import command_inputs
from slipwise.excitation.design import Excitation
from slipwise.files import write_whole
from slipwise.logs.write_bag import COMMAND_TOPIC

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


def write_command_bag(
    path: Path, drive: Excitation, *, topic: str = COMMAND_TOPIC, stamped: bool = False
) -> Path:
    """Write the commands as one MCAP file; return its path.

    A stamped message has the stamp zero, which diff_drive_controller takes for now; with the stamps of a plan
    it would refuse every command as too old.

    Args:
        path: the file.
        drive: what is driven.
        topic: of the commands.
        stamped: write TwistStamped in place of Twist.

    Raises:
        OutputError: the file cannot be written.
    """
    write_whole(path, lambda temporary: _write(temporary, drive, topic, stamped))
    return path


def _write(temporary: Path, drive: Excitation, topic: str, stamped: bool) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types: dict[str, Any] = dict(store.types)
    vector, twist = types["geometry_msgs/msg/Vector3"], types[TWIST]
    no_time = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "base_link")
    kind = TWIST_STAMPED if stamped else TWIST
    commands = command_inputs(drive)
    bag = temporary.parent / "bag"  # the writer wants a folder that is not there yet
    with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(topic, kind, typestore=store)
        columns = (commands.t, commands.v, commands.vy, commands.omega)
        for t, v, vy, omega in zip(*(column.tolist() for column in columns), strict=True):
            message = twist(vector(v, vy, 0.0), vector(0.0, 0.0, omega))
            if stamped:
                message = types[TWIST_STAMPED](no_time, message)
            writer.write(connection, round(t * 1e9), store.serialize_cdr(message, kind))
    (bag / "bag.mcap").rename(temporary)

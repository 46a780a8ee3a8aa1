# SPDX-License-Identifier: Apache-2.0
"""A drive as commands at a fixed rate: a table, or a bag that `ros2 bag play` sends to the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipwise.excitation.design import LEAD, Excitation
from slipwise.excitation.moves import command_periods
from slipwise.files import write_text_whole, write_whole
from slipwise.logs.log import Inputs
from slipwise.logs.write_bag import COMMAND_TOPIC

COMMAND_RATE = 20.0  # Hz; drives stop where a command is older than a fraction of a second
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


def command_inputs(drive: Excitation) -> Inputs:
    """Return the commands at 20 Hz from time zero on; the last one is to stand still."""
    step = 1.0 / COMMAND_RATE
    lead = np.zeros((round(LEAD / step), 3))
    rows = np.vstack((lead, command_periods(drive.moves, step), np.zeros((1, 3))))
    v, vy, omega = np.ascontiguousarray(rows.T)
    return Inputs(t=np.arange(len(rows), dtype=np.float64) * step, v=v, vy=vy, omega=omega)


def write_commands(path: Path, drive: Excitation) -> Path:
    """Write the commands as CSV with t, cmd_v, cmd_omega, or with cmd_vx and cmd_vy; return its path.

    Raises:
        OutputError: the file cannot be written.
    """
    commands = command_inputs(drive)
    columns = {"cmd_v": commands.v, "cmd_omega": commands.omega}
    if drive.space.sideways > 0.0:
        columns = {"cmd_vx": commands.v, "cmd_vy": commands.vy, "cmd_omega": commands.omega}
    rows = zip(commands.t.tolist(), *(column.tolist() for column in columns.values()), strict=True)
    text = "".join(f"{t:.3f}," + ",".join(f"{value:.6g}" for value in row) + "\n" for t, *row in rows)
    write_text_whole(path, ",".join(("t", *columns)) + "\n" + text)
    return path


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

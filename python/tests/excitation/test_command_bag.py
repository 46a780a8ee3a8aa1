# SPDX-License-Identifier: Apache-2.0
"""The bag to play holds every command once, with or without a stamp."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from excitation.samples import small_drive

from slipwise.excitation import command_inputs, write_command_bag


@pytest.mark.parametrize("stamped", [False, True])
def test_bag_holds_the_commands_in_their_time(tmp_path: Path, stamped: bool) -> None:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    drive = small_drive()
    path = write_command_bag(tmp_path / "drive.mcap", drive, topic="/robot/cmd_vel", stamped=stamped)
    rows = []
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        for connection, stamp, data in reader.messages():
            assert connection.topic == "/robot/cmd_vel"
            message = reader.deserialize(data, connection.msgtype)
            if stamped:
                assert (message.header.stamp.sec, message.header.stamp.nanosec) == (0, 0)
                message = message.twist
            rows.append((stamp * 1e-9, message.linear.x, message.angular.z))
    commands = command_inputs(drive)
    np.testing.assert_allclose(rows, np.column_stack((commands.t, commands.v, commands.omega)), atol=1e-9)

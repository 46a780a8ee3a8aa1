# SPDX-License-Identifier: Apache-2.0
"""Starts slipwise beside the robot's own nodes."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Start slipwise beside the robot's own nodes."""
    command = ["slipwise", "live", "--pose-topic", "/rtk/odom", "--name", "husky-1", "--quiet"]
    return LaunchDescription([ExecuteProcess(cmd=command, output="screen", respawn=True)])

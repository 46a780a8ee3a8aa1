# SPDX-License-Identifier: Apache-2.0
"""A bare rclpy node: it hears what `slipwise live` hears, and gives odometry at 50 Hz. ROS costs so much.

`benchmarks/live_node.py` runs it by the Python of `make ros-peer`.
"""

from __future__ import annotations

import contextlib

import rclpy
from geometry_msgs.msg import PoseWithCovarianceStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException

DEPTH = 1000


def main() -> None:
    """Run it until it is interrupted."""
    rclpy.init()
    node = rclpy.create_node("bare")
    odometry = node.create_publisher(Odometry, "~/odometry", DEPTH)
    heard = 0

    def take(message: TwistStamped) -> None:
        nonlocal heard
        heard += 1
        if heard % 2 == 0:
            said = Odometry()
            said.header.stamp = message.header.stamp
            said.twist.twist = message.twist
            odometry.publish(said)

    def ignore(_message: object) -> None:
        """It was heard."""

    node.create_subscription(TwistStamped, "/cmd_vel", take, DEPTH)
    node.create_subscription(Odometry, "/odom", ignore, DEPTH)
    node.create_subscription(PoseWithCovarianceStamped, "/pose", ignore, DEPTH)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main()

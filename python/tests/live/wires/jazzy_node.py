# SPDX-License-Identifier: Apache-2.0
"""A real ROS 2 node for the tests of the wires: run with a Python that has rclpy, asked by lines of JSON."""

from __future__ import annotations

import json
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu
from std_msgs.msg import String


class Robot(Node):
    """Publishes odometry, IMU samples (best effort) and a latched text; hears commands; has one parameter."""

    def __init__(self) -> None:
        super().__init__("robot")
        self.declare_parameter("gain", 1.0)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.odometry = self.create_publisher(Odometry, "/odom", 1000)
        self.imu = self.create_publisher(Imu, "/imu", best_effort)
        self.text = self.create_publisher(String, "/robot_description", latched)
        self.text.publish(String(data="<robot/>"))
        self.commands: list[tuple[int, float]] = []  # number, latency [s]
        self.models: list[str] = []
        self.create_subscription(TwistStamped, "/cmd_vel", self.on_command, 1000)
        self.create_subscription(
            String, "/slipwise/model", lambda text: self.models.append(text.data), latched
        )

    def on_command(self, command: TwistStamped) -> None:
        now = time.time()
        sent = command.header.stamp.sec + command.header.stamp.nanosec * 1e-9
        self.commands.append((int(command.twist.linear.x), now - sent))

    def drive(self, count: int, rate: float) -> None:
        start = time.monotonic()
        for number in range(count):
            time.sleep(max(0.0, start + number / rate - time.monotonic()))
            now = time.time_ns()
            message = Odometry(child_frame_id="base_link")
            message.header.frame_id = "odom"
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 1_000_000_000)
            message.pose.pose.position.x = float(number)
            message.pose.covariance[35] = 0.25
            self.odometry.publish(message)
            if number % 10 == 0:
                self.imu.publish(Imu())

    def matched(self, timeout: float) -> bool:
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            if self.odometry.get_subscription_count() and self.count_publishers("/cmd_vel"):
                return True
            time.sleep(0.01)
        return False

    def publishers(self, topic: str) -> list[tuple[str, str]]:
        found = self.get_publishers_info_by_topic(topic)
        return [(publisher.node_name, str(publisher.topic_type_hash)) for publisher in found]

    def answer(self, asked: dict[str, object]) -> object:
        if asked["do"] == "match":
            return self.matched(10.0)
        if asked["do"] == "drive":
            self.drive(int(str(asked["count"])), float(str(asked["rate"])))
            return asked["count"]
        if asked["do"] == "graph":
            return {"nodes": self.get_node_names(), "publishers": self.publishers("/cmd_vel")}
        if asked["do"] == "gain":
            return self.get_parameter("gain").value
        return {"commands": self.commands, "models": self.models}


def main() -> None:
    rclpy.init()
    robot = Robot()
    executor = SingleThreadedExecutor()
    executor.add_node(robot)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["do"] == "quit":
            break
        print(json.dumps(robot.answer(asked)), flush=True)
    executor.shutdown()
    spinning.join()
    robot.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()

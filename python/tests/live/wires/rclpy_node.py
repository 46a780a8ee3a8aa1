# SPDX-License-Identifier: Apache-2.0
"""The rclpy wire in the Python that has rclpy: hears and sends what the tests ask by lines of JSON."""

from __future__ import annotations

import json
import sys
import threading
import time

from geometry_msgs.msg import TwistStamped
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String

from slipwise.errors import SettingsError
from slipwise.live.wires.rclpy_wire import RclpyWire
from slipwise.live.wires.wire import WireOptions

TWIST = "geometry_msgs/msg/TwistStamped"


class Asked:
    """What was heard, and the answers."""

    def __init__(self, name: str) -> None:
        self.wire = RclpyWire(WireOptions(node_name=name))
        self.heard: dict[str, list[str]] = {"/odom": [], "/imu": [], "/robot_description": []}
        for topic, kind in (("/odom", "nav_msgs/msg/Odometry"), ("/imu", "sensor_msgs/msg/Imu")):
            self.wire.subscribe(
                topic, kind, lambda message, _, topic=topic: self.heard[topic].append(message.hex())
            )
        self.wire.subscribe(
            "/robot_description",
            "std_msgs/msg/String",
            lambda m, _: self.heard["/robot_description"].append(m.hex()),
            latched=True,
        )
        self.wire.advertise("/cmd_vel", TWIST)

    def command(self, count: int) -> int:
        for number in range(count):
            message = TwistStamped()
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
            message.twist.linear.x = float(number)
            self.wire.publish("/cmd_vel", TWIST, serialize_message(message))
            time.sleep(0.01)
        return count

    def set_gain(self, value: float) -> bool:
        parameter = Parameter(name="gain", value=ParameterValue(type=3, double_value=value))
        request = serialize_message(SetParameters.Request(parameters=[parameter]))
        answer = self.wire.call(
            "/robot/set_parameters", "rcl_interfaces/srv/SetParameters", request, timeout=10.0
        )
        return (
            answer is not None and deserialize_message(answer, SetParameters.Response).results[0].successful
        )

    def refused(self) -> str:
        try:
            self.wire.subscribe("/x", "nav_msgs/msg/Odometer", print)
        except SettingsError as error:
            return str(error)
        return ""

    def closed(self) -> list[str]:
        self.wire.close()
        self.wire.close()
        return [thread.name for thread in threading.enumerate() if thread.name.startswith("slipwise")]

    def answer(self, asked: dict[str, object]) -> object:
        do = asked["do"]
        if do == "heard":
            return self.heard
        if do == "connections":
            return self.wire.connections(str(asked["topic"]))
        if do == "topics":
            return [[topic.name, topic.type, topic.publishers] for topic in self.wire.topics()]
        if do == "command":
            return self.command(int(str(asked["count"])))
        if do == "gain":
            return self.set_gain(float(str(asked["value"])))
        if do == "model":
            text = serialize_message(String(data="schema: 6"))
            self.wire.publish("/slipwise/model", "std_msgs/msg/String", text, latched=True)
            return True
        return self.refused() if do == "refused" else self.closed()


def main() -> None:
    asked = Asked(sys.argv[1])
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        question = json.loads(line)
        if question["do"] == "quit":
            break
        print(json.dumps(asked.answer(question)), flush=True)
    asked.wire.close()


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""A real ROS 2 node that manages slipwise's and plays messages to it: asked by lines of JSON."""

from __future__ import annotations

import json
import sys
import threading
from collections import Counter
from typing import Any

import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from ros_player import play
from slipwise_msgs.msg import MotionModel, SlipState
from slipwise_msgs.srv import PredictPath
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

PATIENCE = 20.0  # s


class Manager:
    """Keeps the last latched messages of a node, and how many of each came."""

    def __init__(self, name: str) -> None:
        self.node, self.name = rclpy.create_node("manager"), name
        self.last: dict[str, Any] = {}
        self.count: Counter[str] = Counter()
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        for topic, kind in (("motion_model", MotionModel), ("slip_state", SlipState), ("model", String)):
            self._hear(topic, kind, latched)
        self._hear("odometry", Odometry, QoSProfile(depth=1000))

    def _hear(self, topic: str, kind: type, quality: QoSProfile) -> None:
        def take(message: Any) -> None:
            self.last[topic] = message
            self.count[topic] += 1

        self.node.create_subscription(kind, f"{self.name}/{topic}", take, quality)

    def call(self, kind: Any, service: str, request: Any) -> Any:
        client = self.node.create_client(kind, f"{self.name}/{service}")
        assert client.wait_for_service(PATIENCE), service
        done = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _: done.set())
        assert done.wait(PATIENCE), service
        return future.result()

    def answer(self, do: str, asked: dict[str, Any]) -> object:
        if do == "change":
            number = getattr(Transition, f"TRANSITION_{asked['to'].upper()}")
            return self.call(
                ChangeState, "change_state", ChangeState.Request(transition=Transition(id=number))
            ).success
        if do == "state":
            return self.call(GetState, "get_state", GetState.Request()).current_state.label
        if do == "trigger":
            said = self.call(Trigger, asked["service"], Trigger.Request())
            return [said.success, said.message]
        if do == "freeze":
            said = self.call(SetBool, "freeze", SetBool.Request(data=asked["on"]))
            return [said.success, said.message]
        if do == "predict":
            return self.predict(asked)
        if do == "set":
            value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=asked["value"])
            request = SetParameters.Request(parameters=[Parameter(name=asked["name"], value=value)])
            (done,) = self.call(SetParameters, "set_parameters", request).results
            return [done.successful, done.reason]
        if do == "get":
            asking = GetParameters.Request(names=asked["names"])
            found = self.call(GetParameters, "get_parameters", asking).values
            return dict(zip(asked["names"], map(parameter_value_to_python, found), strict=True))
        if do == "describe":
            request = DescribeParameters.Request(names=asked["names"])
            found = self.call(DescribeParameters, "describe_parameters", request).descriptors
            return {each.name: each.description for each in found}
        if do == "play":
            self.last.pop("odometry", None)
            return play(self.node, asked["file"], asked["rate"], lambda: self.last.get("odometry"))
        return {
            "count": dict(self.count),
            "model": self.last["model"].data if "model" in self.last else "",
            "motion_model": self.bytes_of("motion_model"),
            "slip_state": self.bytes_of("slip_state"),
            "segments": self.last["slip_state"].segments if "slip_state" in self.last else 0,
            "reason": self.last["slip_state"].reason if "slip_state" in self.last else "",
        }

    def bytes_of(self, topic: str) -> str:
        return serialize_message(self.last[topic]).hex() if topic in self.last else ""

    def predict(self, asked: dict[str, Any]) -> object:
        request = PredictPath.Request(horizon=asked["horizon"], t=asked["t"], v=asked["v"])
        request.omega = asked["omega"]
        said = self.call(PredictPath, "predict_path", request)
        places = [(pose.pose.position.x, pose.pose.position.y) for pose in said.path.poses]
        return {"success": said.success, "message": said.message, "path": places, "n": len(said.covariance)}


def main(name: str) -> None:
    rclpy.init()
    manager = Manager(name)
    executor = SingleThreadedExecutor()
    executor.add_node(manager.node)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["do"] == "quit":
            break
        print(json.dumps(manager.answer(asked["do"], asked)), flush=True)
    executor.shutdown()
    spinning.join()
    manager.node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1])

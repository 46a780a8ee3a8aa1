# SPDX-License-Identifier: Apache-2.0
"""Stand-ins for nodes of Nav2, ros2_control and robot_localization, with the descriptors of these."""

from __future__ import annotations

import json
import sys
import threading

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

READ_ONLY = ["wheel_separation_multiplier", "left_wheel_radius_multiplier", "right_wheel_radius_multiplier"]
DIAGONALS = ("twist_covariance_diagonal", "pose_covariance_diagonal")
VELOCITY = (
    "linear.x.max_velocity",
    "linear.x.min_velocity",
    "angular.z.max_velocity",
    "angular.z.min_velocity",
)
MPPI = {
    "FollowPath.motion_model": "diff_drive",
    "FollowPath.model_delay_vx": 0.0,
    "FollowPath.model_delay_vy": 0.0,
    "FollowPath.model_delay_wz": 0.0,
    "FollowPath.vx_max": 1.0,
    "FollowPath.vx_min": -0.35,
    "FollowPath.wz_max": 1.9,
    "FollowPath.ax_max": 3.0,
    "FollowPath.ax_min": -3.0,
    "FollowPath.az_max": 3.5,
    "FollowPath.VelocityDeadbandCritic.deadband_velocities": [0.0, 0.0, 0.0],
}


class Upstream(Node):
    """A node with parameters; counts how many values each call sets."""

    def __init__(self, name: str, values: dict[str, object], read_only: tuple[str, ...] = ()) -> None:
        super().__init__(name)
        for parameter, value in values.items():
            self.declare_parameter(parameter, value, ParameterDescriptor(read_only=parameter in read_only))
        self.names = list(values)
        self.calls: list[list[str]] = []
        self.add_on_set_parameters_callback(self.on_set)

    def on_set(self, parameters: list[Parameter]) -> SetParametersResult:
        self.calls.append([parameter.name for parameter in parameters])
        return SetParametersResult(successful=True)

    def values(self) -> dict[str, object]:
        found = {name: self.get_parameter(name).value for name in self.names}
        return {
            name: list(v) if hasattr(v, "__len__") and not isinstance(v, str) else v
            for name, v in found.items()
        }


def nodes() -> list[Upstream]:
    wheels: dict[str, object] = dict.fromkeys(READ_ONLY, 1.0) | {name: [0.001] * 6 for name in DIAGONALS}
    wheels |= dict.fromkeys(VELOCITY, float("nan"))
    fixed = (*READ_ONLY, *DIAGONALS)
    noise: dict[str, object] = {"frequency": 30.0, "process_noise_covariance": [0.01] * 225}
    return [
        Upstream("diff_drive_controller", wheels, fixed),
        Upstream("controller_server", dict(MPPI)),
        Upstream("older_controller", dict(MPPI), ("FollowPath.model_delay_wz",)),
        Upstream("amcl", {"robot_model_type": "x", **{f"alpha{i}": 0.2 for i in range(1, 6)}}),
        Upstream("ekf_filter_node", noise),
    ]


def main() -> None:
    rclpy.init()
    executor, made = SingleThreadedExecutor(), nodes()
    for node in made:
        executor.add_node(node)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        if json.loads(line)["do"] == "quit":
            break
        found = {node.get_name(): {"values": node.values(), "calls": node.calls} for node in made}
        print(json.dumps(found), flush=True)
    executor.shutdown()
    spinning.join()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()

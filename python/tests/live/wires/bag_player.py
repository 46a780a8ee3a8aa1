# SPDX-License-Identifier: Apache-2.0
"""A real ROS 2 node that plays messages: run with a Python that has rclpy, given a file of JSON lines.

What the node under test publishes is counted, and printed at the end.
"""

from __future__ import annotations

import json
import sys
import threading
from collections import Counter

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from ros_player import get_message, play

HEARD = {
    "odometry": "nav_msgs/msg/Odometry",
    "twist": "geometry_msgs/msg/TwistWithCovarianceStamped",
    "predicted_path": "nav_msgs/msg/Path",
    "diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "model": "std_msgs/msg/String",
    "surface": "std_msgs/msg/String",
    "surfaces": "slipwise_msgs/msg/Surfaces",
    "next_moves": "slipwise_msgs/msg/NextMoves",
}
LATCHED = ("model", "surface", "surfaces", "next_moves")


def plain(surfaces: object) -> dict[str, object]:
    remembered = sorted(each.name for each in surfaces.remembered)
    names, probabilities = list(surfaces.names), list(surfaces.probabilities)
    labels = [surfaces.labels_judged, surfaces.labels_right]
    return {"names": names, "probabilities": probabilities, "remembered": remembered, "labels": labels}


def main(file: str, rate: float) -> None:
    rclpy.init()
    node = rclpy.create_node("player")
    heard: Counter[str] = Counter()
    last: dict[str, object] = {}
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def take(name: str, message: object) -> None:
        heard[name] += 1
        last[name] = message

    for name, kind in HEARD.items():
        quality = latched if name in LATCHED else 100
        node.create_subscription(
            get_message(kind), f"/slipwise/{name}", lambda message, n=name: take(n, message), quality
        )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    play(node, file, rate, lambda: last.get("odometry"))
    odometry, model = last.get("odometry"), last.get("model")
    found = {
        "heard": dict(heard),
        "frame": odometry.header.frame_id if odometry else "",
        "model": model.data[:40] if model else "",
        "surface": last["surface"].data if "surface" in last else None,
        "surfaces": plain(last["surfaces"]) if "surfaces" in last else None,
        "moves": len(last["next_moves"].moves) if "next_moves" in last else 0,
        "nodes": node.get_node_names(),
    }
    print(json.dumps(found), flush=True)
    executor.shutdown()
    spinning.join()
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))

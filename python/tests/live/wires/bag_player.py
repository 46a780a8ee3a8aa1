# SPDX-License-Identifier: Apache-2.0
"""A real ROS 2 node that plays messages: run with a Python that has rclpy, given a file of JSON lines.

Each line has the time of sending [s], the topic, the type and the message as base64; subscribers of all
topics are waited for. What the node under test publishes is counted, and printed at the end.
"""

from __future__ import annotations

import base64
import json
import sys
import threading
import time
from collections import Counter
from importlib import import_module
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile

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


def get_message(name: str) -> type:
    package, kind, message = name.split("/")
    return getattr(import_module(f"{package}.{kind}"), message)


def plain(surfaces: object) -> dict[str, object]:
    remembered = sorted(each.name for each in surfaces.remembered)
    names, probabilities = list(surfaces.names), list(surfaces.probabilities)
    labels = [surfaces.labels_judged, surfaces.labels_right]
    return {"names": names, "probabilities": probabilities, "remembered": remembered, "labels": labels}


def main(file: str, rate: float) -> None:
    rclpy.init()
    node = rclpy.create_node("player")
    lines = [json.loads(line) for line in Path(file).read_text().splitlines()]
    types = {line["topic"]: line["type"] for line in lines}
    publishers = {
        topic: node.create_publisher(get_message(kind), topic, 1000) for topic, kind in types.items()
    }
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
    until = time.monotonic() + 60.0
    while not all(each.get_subscription_count() for each in publishers.values()) and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(1.0)
    begin = time.monotonic()
    for line in lines:
        time.sleep(max(0.0, begin + (line["t"] - lines[0]["t"]) / rate - time.monotonic()))
        publishers[line["topic"]].publish(base64.b64decode(line["message"]))
    time.sleep(2.0)
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

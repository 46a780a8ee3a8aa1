# SPDX-License-Identifier: Apache-2.0
"""Plays messages from a real ROS 2 node, until who is taught by them has taken the last one.

Run with a Python that has rclpy. Each line of a file has the time of sending [s], the topic, the type and the
message as base64.
"""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

HEARD_WITHIN = 60.0  # s until all topics have subscribers
TAKEN_WITHIN = 20.0  # s for the last messages of a busy machine
BEHIND = 1.0  # s that the odometry of a node that has taken all may be behind the last message


def get_message(name: str) -> type:
    package, kind, message = name.split("/")
    return getattr(import_module(f"{package}.{kind}"), message)


def play(node: Any, file: str, rate: float, odometry: Callable[[], Any]) -> int:
    """Publish the messages of a file at a rate; subscribers of all topics are waited for.

    `odometry` returns what the node that is taught said last of its motion, None before.
    """
    lines = [json.loads(line) for line in Path(file).read_text().splitlines()]
    types = {line["topic"]: line["type"] for line in lines}
    publishers = {
        topic: node.create_publisher(get_message(kind), topic, 1000) for topic, kind in types.items()
    }
    until = time.monotonic() + HEARD_WITHIN
    while not all(each.get_subscription_count() for each in publishers.values()):
        assert time.monotonic() < until, "nobody subscribes"
        time.sleep(0.05)
    time.sleep(1.0)
    begin = time.monotonic()
    for line in lines:
        time.sleep(max(0.0, begin + (line["t"] - lines[0]["t"]) / rate - time.monotonic()))
        publishers[line["topic"]].publish(base64.b64decode(line["message"]))
    until = time.monotonic() + TAKEN_WITHIN
    while stamp_of(odometry()) < lines[-1]["t"] - BEHIND and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(2.0)
    for publisher in publishers.values():
        node.destroy_publisher(publisher)
    return len(lines)


def stamp_of(message: Any) -> float:
    """Return the stamp of a message [s]; of none, one long ago."""
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec if message else -float("inf")

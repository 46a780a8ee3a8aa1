# SPDX-License-Identifier: Apache-2.0
"""The rospy wire in a process of its own, which can have one node of ROS 1; asked by lines of JSON."""

from __future__ import annotations

import json
import sys

from live.wires.wire_messages import ODOMETRY, STRING, TWIST, command

from slipwise.errors import SettingsError
from slipwise.live.wires.options import WireOptions
from slipwise.live.wires.rospy_wire import RospyWire


def main() -> None:
    wire = RospyWire(WireOptions())
    heard: list[str] = []
    text: list[str] = []
    wire.subscribe("/odom", ODOMETRY, lambda message: heard.append(message.hex()))
    wire.subscribe("/robot_description", STRING, lambda message: text.append(message.hex()), latched=True)
    wire.advertise("/cmd_vel", TWIST)
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["do"] == "quit":
            break
        answer: object = {"heard": heard, "text": text}
        if asked["do"] == "command":
            for number in range(asked["count"]):
                wire.publish("/cmd_vel", TWIST, command(number))
        elif asked["do"] == "connections":
            answer = wire.connections(asked["topic"])
        elif asked["do"] == "topics":
            answer = [[topic.name, topic.type, topic.publishers] for topic in wire.topics()]
        elif asked["do"] == "close":
            wire.close()
            wire.close()
            try:
                wire.publish("/late", STRING, b"")
            except SettingsError as error:
                answer = str(error)
        print(json.dumps(answer), flush=True)
    wire.close()


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""A node of ROS 1 for the tests of the wire; asked by lines of JSON."""

from __future__ import annotations

import json
import sys

import rospy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import String


def main() -> None:
    rospy.init_node("robot", disable_signals=True)
    odometry = rospy.Publisher("/odom", Odometry, queue_size=100)
    text = rospy.Publisher("/robot_description", String, latch=True, queue_size=1)
    text.publish(String(data="<robot/>"))
    commands: list[tuple[float, int, str]] = []
    rospy.Subscriber(
        "/cmd_vel",
        TwistStamped,
        lambda command: commands.append(
            (command.twist.linear.x, command.header.stamp.secs, command.header.frame_id)
        ),
    )
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        if asked["do"] == "quit":
            break
        if asked["do"] == "drive":
            while not odometry.get_num_connections():
                rospy.sleep(0.01)
            for number in range(asked["count"]):
                message = Odometry(child_frame_id="base_link")
                message.header.stamp = rospy.Time(100 + number, 5)
                message.pose.pose.position.x = float(number)
                odometry.publish(message)
                rospy.sleep(0.01)
        print(json.dumps(commands), flush=True)
    rospy.signal_shutdown("the tests end")


if __name__ == "__main__":
    main()

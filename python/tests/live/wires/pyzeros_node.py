# SPDX-License-Identifier: Apache-2.0
"""A node of pyzeros, which speaks rmw_zenoh's format, for the tests of the wire; asked by lines of JSON."""

from __future__ import annotations

import asyncio
import json
import sys
import time

import numpy as np
import pyzeros
import pyzeros.pub
import zenoh
from pyzeros.builtin_msgs import Attachment
from ros2_pyterfaces.cydr.all_msgs import Odometry, TwistStamped
from ros2_pyterfaces.cydr.all_srvs import Trigger


def open_session(address: str) -> zenoh.Session:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("listen/endpoints", json.dumps([address]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


class Robot:
    """Publishes odometry, hears commands, serves a button."""

    def __init__(self, address: str) -> None:
        self.session = open_session(address)
        self.node = pyzeros.Node("robot", session=self.session, namespace="/")
        self.odometry = self.node.create_publisher(Odometry, "/odom")
        self.commands: list[tuple[int, float, int, int]] = []  # number, latency [s], sequence, bytes
        self.hearing = pyzeros.sub.RawSub(TwistStamped, "/cmd_vel", self.on_command, session=self.node)
        self.pressed = 0

    def on_command(self, sample: zenoh.Sample) -> None:
        now = time.time()
        command = TwistStamped.deserialize(sample.payload.to_bytes())
        sent = int(command.header.stamp.sec) + int(command.header.stamp.nanosec) * 1e-9
        beside = sample.attachment.to_bytes()
        number = int(Attachment.deserialize(b"\x00\x01\x00\x00" + beside).sequence_number)
        self.commands.append((int(command.twist.linear.x), now - sent, number, len(beside)))

    async def serve(self) -> None:
        server = self.node.create_service(Trigger, "/robot/press")
        async for asked in server.listen_reliable():
            self.pressed += 1
            asked.response.success = np.bool_(True)
            asked.response.message = b"pressed"
            asked.send()

    def drive(self, count: int, rate: float) -> int:
        start = time.monotonic()
        for number in range(count):
            time.sleep(max(0.0, start + number / rate - time.monotonic()))
            message = Odometry(child_frame_id=b"base_link")
            seconds, rest = divmod(time.time_ns(), 1_000_000_000)
            message.header.stamp.sec, message.header.stamp.nanosec = np.int32(seconds), np.uint32(rest)
            message.pose.pose.position.x = np.float64(number)
            self.odometry.publish(message)
        return count

    def tokens(self) -> dict[str, object]:
        """Return the tokens of others, and what pyzeros itself would write for a publisher of commands."""
        found = [str(reply.ok.key_expr) for reply in self.session.liveliness().get("@ros2_lv/**") if reply.ok]
        expected = pyzeros.pub.token_keyexpr(
            "/cmd_vel",
            "geometry_msgs::msg::dds_::TwistStamped_",
            TwistStamped.hash_rihs01(),
            node_name="slipwise",
            session=self.session,
        )
        return {"found": found, "expected": expected}

    def answer(self, asked: dict[str, object]) -> object:
        if asked["do"] == "drive":
            return self.drive(int(str(asked["count"])), float(str(asked["rate"])))
        if asked["do"] == "tokens":
            return self.tokens()
        return self.pressed if asked["do"] == "pressed" else self.commands


def compile_messages() -> None:
    """Let pyzeros compile what it needs; it keeps that in the folder that CYDR_CACHE_DIR names."""
    for kind in (Attachment, Odometry, TwistStamped, Trigger.Request, Trigger.Response):
        kind.deserialize(kind().serialize())


async def main() -> None:
    compile_messages()
    if sys.argv[1] == "compile":
        return
    robot = Robot(sys.argv[1])
    serving = asyncio.create_task(robot.serve())
    loop = asyncio.get_running_loop()
    await asyncio.sleep(0.1)
    print(json.dumps("ready"), flush=True)
    while line := await loop.run_in_executor(None, sys.stdin.readline):
        asked = json.loads(line)
        if asked["do"] == "quit":
            break
        print(json.dumps(await loop.run_in_executor(None, robot.answer, asked)), flush=True)
    serving.cancel()
    robot.session.close()


if __name__ == "__main__":
    asyncio.run(main())

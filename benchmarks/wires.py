# SPDX-License-Identifier: Apache-2.0
"""Messages lost and latencies between the live node on Cyclone DDS and a real ROS 2 Jazzy node, both ways.

It wants `make ros-peer`. Latency is from the stamp, set just before publishing, to the callback, in Python
on this host.

    python benchmarks/wires.py --seconds 60
"""

from __future__ import annotations

import argparse
import os
import struct
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python" / "tests"))

from live.wires.peer import DOMAIN, Peer  # noqa: E402
from live.wires.wire_messages import ODOMETRY, TWIST, command, wait_until  # noqa: E402

from slipwise.live.wires.cyclone_wire import CycloneWire  # noqa: E402
from slipwise.live.wires.ros_types import type_hash  # noqa: E402
from slipwise.live.wires.wire import WireOptions  # noqa: E402

_STAMP = struct.Struct("<iI")  # s, ns, behind the 4 bytes of CDR's header


class Heard:
    """Latencies [s] of the messages that came."""

    def __init__(self) -> None:
        self.latencies: list[float] = []

    def __call__(self, message: bytes, _arrived: float) -> None:
        """Take one in."""
        now = time.time()
        seconds, rest = _STAMP.unpack_from(message, 4)
        self.latencies.append(now - seconds - rest * 1e-9)


def drive_both(robot: Peer, wire: CycloneWire, count: int, rate: float) -> float:
    """Let both publish; return the processor time that this process used, as a share of one core."""
    robot.tell("drive", count=count, rate=rate)
    begun, start = time.process_time(), time.monotonic()
    for number in range(count):
        time.sleep(max(0.0, start + number / rate - time.monotonic()))
        wire.publish("/cmd_vel", TWIST, command(number))
    used = (time.process_time() - begun) / (time.monotonic() - start)
    robot.hear()
    time.sleep(1.0)  # until what was lost has been sent again
    return used


def print_row(name: str, sent: int, latencies: list[float]) -> None:
    """Print one direction."""
    p50, p99, worst = 1e3 * np.percentile(latencies, (50, 99, 100)) if latencies else (np.nan,) * 3
    print(f"{name:34} {sent:7} {sent - len(latencies):5} {p50:8.2f} {p99:8.2f} {worst:8.2f}")


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=100.0, help="messages a second each way")
    options = parser.parse_args()
    python = Path(os.environ.get("SLIPWISE_ROS_VENV") or ROOT / ".venv-ros") / "bin" / "python"
    if not python.exists():
        sys.exit(f"there is no {python}: run `make ros-peer` first")
    count, heard = int(options.seconds * options.rate), Heard()
    wire = CycloneWire(WireOptions(domain=DOMAIN))
    with (
        tempfile.TemporaryDirectory() as logs,
        Peer(
            python, "jazzy_node.py", environment={"ROS_LOG_DIR": logs}, patience=options.seconds + 60.0
        ) as robot,
    ):
        wire.subscribe("/odom", ODOMETRY, heard)
        wire.advertise("/cmd_vel", TWIST)
        matched = robot.ask("match")
        if not (matched and wait_until(lambda: wire.connections("/odom") and wire.connections("/cmd_vel"))):
            sys.exit("the two nodes do not find each other")
        used = drive_both(robot, wire, count, options.rate)
        received = [latency for _, latency in robot.ask("received")["commands"]]
        graph = robot.ask("graph")
    wire.close()
    print(f"{'direction':34} {'sent':>7} {'lost':>5} {'p50 ms':>8} {'p99 ms':>8} {'worst':>8}")
    print_row("Jazzy -> slipwise, Odometry", count, heard.latencies)
    print_row("slipwise -> Jazzy, TwistStamped", count, received)
    print(f"node name seen by Jazzy: {'slipwise' in graph['nodes']}")
    print(f"type hash seen by Jazzy: {['slipwise', type_hash(TWIST)] in graph['publishers']}")
    print(
        f"processor time here: {100 * used:.1f} % of one core; load of the machine {os.getloadavg()[0]:.1f}"
    )


if __name__ == "__main__":
    main()

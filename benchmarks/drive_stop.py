# SPDX-License-Identifier: Apache-2.0
"""How soon a robot that `slipwise excite --drive` drives hears the command to stand, over Cyclone DDS.

A simulated robot (MuJoCo, the Land Tamer) in a process of its own publishes poses and the dead man's button
at 20 Hz. In the middle of a move the button is released, or falls silent, or poses end. The time runs from
there to the first command to stand that the robot hears.

    python benchmarks/drive_stop.py --trials 30
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python" / "tests"))

from live.driven_robot import DrivenRobot

from slipwise.cli.output import Column, Output
from slipwise.excitation import Move
from slipwise.live.drive_guard import DriveBounds, DriveGuard
from slipwise.live.drive_ros import DriveTopics, RosDriveLink
from slipwise.live.self_drive import DrivePlan, SelfDrive
from slipwise.live.wires.cyclone_wire import CycloneWire
from slipwise.live.wires.options import WireOptions

DOMAIN = 1 + os.getpid() % 100
CASES = ("release_at", "silent_at", "blind_at")
BOUNDS = DriveBounds(-9.0, 9.0, -9.0, 9.0, speed=1.0, yaw_rate=1.0)
PLAN = DrivePlan((Move(0.5, 0.3, 2.0, 0.0),), lead=0.2, countdown=0.1, stand=0.3)


def robot(case: str, count: int, domain: int) -> None:
    """Be a robot until standard input ends; print how soon the command to stand came [s]."""
    made = DrivenRobot(CycloneWire(WireOptions(node_name="robot", domain=domain)), **{case: count})
    sys.stdin.read()
    print(made.stood_after)
    made.close()


def trial(case: str, count: int) -> float:
    """Drive a robot of another process; return how soon the command to stand came [s]."""
    command = [sys.executable, __file__, "--robot", case, str(count), str(DOMAIN)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        link = RosDriveLink(CycloneWire(WireOptions(domain=DOMAIN)), DriveTopics("/dead_man", "/pose"))
        report = SelfDrive(link, DriveGuard(BOUNDS), PLAN, say=lambda _: None).run()
        said, _ = process.communicate("", timeout=30.0)
        link.close()
    if not report.why:
        raise SystemExit(f"{case} did not stop the drive")
    return float(said)


def main() -> int:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=30, help="of each case")
    parser.add_argument("--robot", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.robot:
        robot(options.robot[0], int(options.robot[1]), int(options.robot[2]))
        return 0
    rng, rows = np.random.default_rng(1), []
    for case in CASES:
        times = 1e3 * np.array([trial(case, int(rng.integers(3, 25))) for _ in range(options.trials)])
        rows.append([case.removesuffix("_at"), *(f"{x:.1f}" for x in np.percentile(times, (50, 90, 100)))])
    head = [
        Column("button or pose"),
        *(Column(n, right=True) for n in ("p50 [ms]", "p90 [ms]", "worst [ms]")),
    ]
    Output(None).table("From what makes the robot stop to the command to stand", head, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())

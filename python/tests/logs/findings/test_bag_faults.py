# SPDX-License-Identifier: Apache-2.0
"""Faults that only a bag shows, put into bags of a simulated drive and of real ones: each is found."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import dead_reckoned
from field.test_localiser import write_localiser
from sample_bags import EPOCH, ODOMETRY, POSE, SECOND, Bag
from sample_field import (
    STEP,
    Clock,
    FieldDrive,
    field_drive,
    recorder,
    write_commands,
    write_poses,
    write_wheels,
)

from slipwise.logs import LogOptions, open_log
from slipwise.logs.findings.diagnose import diagnose

SECONDS = 90.0
CERTAIN = "geometry_msgs/msg/PoseWithCovarianceStamped"
#: Logs with commands and wheels.
REAL = (
    "husky/tile_deflated_tyres",
    "husky/wetgrass_bad_poses",
    "warthog/grass_7_29_14h46s15",
    "warthog/grass_8_8_15h56s39",
    "f1tenth/DS3",
)


def clock(seconds: float = 0.0, rate: float = 1.0, begin: float = EPOCH / SECOND) -> Clock:
    """Return a clock that is so much ahead of the recorder's, or begins elsewhere and runs at a rate."""
    return lambda t: round((begin + seconds) * SECOND) + round(rate * t * SECOND)


def simulated(bag: Bag, drive: FieldDrive) -> None:
    received, stamped = clock(rate=1.25), clock(begin=12.0)
    write_commands(bag, drive, received=received)
    write_poses(bag, drive, received=received, stamped=stamped)
    write_wheels(bag, drive, received=received, stamped=stamped)


def ahead(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_poses(bag, drive, stamped=clock(1.7))
    write_wheels(bag, drive, stamped=clock(1.7))


def wheels_apart(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_poses(bag, drive)
    write_wheels(bag, drive, stamped=clock(-4.0))


def slewed(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_poses(bag, drive)
    write_wheels(bag, drive, stamped=clock(rate=1.003))


def set_back(bag: Bag, drive: FieldDrive) -> None:
    def jumping(t: float) -> int:
        return recorder(t - (10.0 if t > 40.0 else 0.0))

    write_commands(bag, drive)
    write_poses(bag, drive, stamped=jumping)
    write_wheels(bag, drive, stamped=jumping)


def random_stamps(bag: Bag, drive: FieldDrive) -> None:
    rng = np.random.default_rng(3)
    write_commands(bag, drive)
    write_poses(bag, drive)
    write_wheels(bag, drive, stamped=lambda _: EPOCH + int(rng.uniform(0.0, 90.0) * SECOND))


def without_twist(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_poses(bag, drive)
    for k in drive.every(0.05):
        stamp = recorder(drive.t[k])
        bag.add(stamp, "/odom", ODOMETRY, bag.odometry(stamp, *map(float, drive.odometry[k])))


def of_another_robot(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive, topic="/r1/cmd_vel")
    write_poses(bag, drive, topic="/r1/mocap/pose")
    write_wheels(bag, drive, topic="/r2/odom")


def nobody_publishes(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_poses(bag, drive)
    bag.silent["/odom"] = ODOMETRY


def without_rotation(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_wheels(bag, drive)
    for k in drive.every(0.1):
        stamp = recorder(drive.t[k])
        pose = bag.pose(*map(float, drive.pose[k]))
        pose.orientation.w = pose.orientation.z = 0.0
        bag.add(stamp, "/mocap/pose", POSE, bag.make(POSE, bag.header(stamp), pose))


def exact(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_wheels(bag, drive)
    for k in drive.every(0.1):
        stamp = recorder(drive.t[k])
        measured = bag.pose(*map(float, drive.pose[k]))
        pose = bag.make("geometry_msgs/msg/PoseWithCovariance", measured, np.zeros(36))
        bag.add(stamp, "/amcl_pose", CERTAIN, bag.make(CERTAIN, bag.header(stamp), pose))


def postdated(bag: Bag, drive: FieldDrive) -> None:
    write_commands(bag, drive)
    write_wheels(bag, drive)
    write_localiser(bag, drive, tolerance=1.0, every=0.2)


FAULTS: dict[str, tuple[Callable[[Bag, FieldDrive], None], str]] = {
    "time at 0.8 of real time": (simulated, "clock-rate"),
    "headers 1.7 s ahead": (ahead, "clock-apart"),
    "wheels on another computer": (wheels_apart, "clock-of-topic"),
    "a clock that is slewed": (slewed, "clock-slewed"),
    "clock set back": (set_back, "clock-set-back"),
    "random stamps": (random_stamps, "no-clock"),
    "no twist": (without_twist, "zero-twist"),
    "two robots": (of_another_robot, "other-robot"),
    "odometry nobody publishes": (nobody_publishes, "silent-topic"),
    "no rotation": (without_rotation, "no-rotation"),
    "covariances of zeros": (exact, "zero-covariance"),
    "transform tolerance": (postdated, "postdated-poses"),
}


def not_found(drive: FieldDrive, folder: Path, name: str = "") -> list[str]:
    """Return each fault that is not found in a bag of a drive, and what else is found."""
    missed = []
    for fault, (write, kind) in FAULTS.items():
        bag = Bag()
        write(bag, drive)
        bag.messages.sort(key=lambda each: each[0])
        found = [each.kind for each in diagnose(bag.write(folder / f"{name}{kind}.mcap"), LogOptions()).found]
        if kind not in found:
            missed.append(f"{name}, {fault}: {found}")
    return missed


def test_each_fault_is_found_in_a_bag_of_a_simulated_drive(tmp_path: Path) -> None:
    assert not_found(field_drive(60.0), tmp_path) == []


def real_drive(path: Path) -> FieldDrive:
    """Return the beginning of a log as a drive: what was commanded, and what wheels and poses did."""
    log = open_log(path, wheelbase=0.32 if path.parent.name == "f1tenth" else None)
    run = max((each for each in log.runs if each.commands and each.wheels), key=lambda each: len(each.poses))
    commands, wheels, poses = run.commands, run.wheels, run.poses
    assert commands is not None
    assert wheels is not None
    begin = max(commands.t[0], wheels.t[0], poses.t[0])
    t = STEP * np.arange(round(SECONDS / STEP))
    now = begin + t
    held = np.clip(np.searchsorted(commands.t, now, side="right") - 1, 0, None)
    yaw = np.unwrap(poses.yaw)
    path_ = dead_reckoned(wheels)
    own = [np.interp(now, path_.t, column) for column in (path_.x, path_.y, np.unwrap(path_.yaw))]
    return FieldDrive(
        t,
        np.column_stack((commands.v[held], commands.omega[held])),
        np.column_stack([np.interp(now, wheels.t, column) for column in (wheels.v, wheels.omega)]),
        np.column_stack([np.interp(now, poses.t, column) for column in (poses.x, poses.y, yaw)]),
        np.column_stack(own),
    )


@pytest.mark.slow
def test_each_fault_is_found_in_bags_of_real_drives(real_log_dir: Path, tmp_path: Path) -> None:
    missed = []
    for name in REAL:
        drive = real_drive(real_log_dir / f"{name}.csv.gz")
        missed += not_found(drive, tmp_path, name.replace("/", "-"))
    assert missed == []

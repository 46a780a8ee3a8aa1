# SPDX-License-Identifier: Apache-2.0
"""A localiser behind TF stamps corrections into the future; they are dated by the odometry of before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_bags import Bag
from sample_field import (
    FieldDrive,
    field_drive,
    learned,
    recorder,
    share_errors,
    write_commands,
    write_wheels,
)

from slipwise.logs.log import Floats
from slipwise.logs.messages import TF

SHARES = (0.954, 0.954 / 1.64)  # a separation multiplier of 1.64


def compose(first: Floats, second: Floats) -> tuple[float, float, float]:
    c, s = np.cos(first[2]), np.sin(first[2])
    x, y = first[0] + c * second[0] - s * second[1], first[1] + s * second[0] + c * second[1]
    return float(x), float(y), float(first[2] + second[2])


def inverse(pose: Floats) -> Floats:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.array((-c * pose[0] - s * pose[1], s * pose[0] - c * pose[1], -pose[2]))


def write_localiser(
    bag: Bag, drive: FieldDrive, *, tolerance: float, every: float, least: float = 0.05, prefix: str = ""
) -> None:
    """Write odom -> base_link at 50 Hz, and map -> odom as AMCL does: a new one where the robot has moved on.

    It is computed 50 to 90 ms after a scan, from the odometry of the scan, and stamped `tolerance` [s] later.
    """
    rng = np.random.default_rng(5)
    odom, base = f"{prefix}odom", f"{prefix}base_link"
    for k in drive.every(0.02):
        stamp = recorder(drive.t[k])
        bag.add(stamp, "/tf", TF, bag.transform(stamp, odom, base, tuple(map(float, drive.odometry[k]))))
    correction, last = (0.0, 0.0, 0.0), drive.odometry[0]
    for k in drive.every(every):
        moved = np.abs(drive.odometry[k] - last)
        if np.hypot(moved[0], moved[1]) > least or moved[2] > least:
            estimate = drive.pose[k] + rng.standard_normal(3) * (0.02, 0.02, 0.01)
            correction, last = compose(estimate, inverse(drive.odometry[k])), drive.odometry[k]
        received = recorder(drive.t[k] + rng.uniform(0.05, 0.09))
        stamp = recorder(drive.t[k] + tolerance)
        bag.add(received, "/tf", TF, bag.transform(stamp, "map", odom, correction))
    bag.messages.sort(key=lambda each: each[0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tolerance", "every", "prefix"), [(1.0, 0.2, ""), (1.0, 0.5, "tb3/"), (0.5, 0.3, ""), (0.1, 0.2, "")]
)
def test_corrections_of_a_localiser_are_dated_by_the_odometry_they_came_from(
    tmp_path: Path, tolerance: float, every: float, prefix: str
) -> None:
    drive, bag = field_drive(240.0, shares=SHARES), Bag()
    write_commands(bag, drive)
    write_wheels(bag, drive)
    write_localiser(bag, drive, tolerance=tolerance, every=every, prefix=prefix)
    result, said = learned(bag.write(tmp_path / "amcl.mcap"), "wheel")
    assert f"map -> {prefix}odom is stamped" in said
    assert "only those at corrections are used" in said
    assert result.verdict.good
    assert np.abs(share_errors(result.model, SHARES)).max() < 2.0

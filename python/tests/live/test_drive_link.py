# SPDX-License-Identifier: Apache-2.0
"""What was driven is a log that slipwise reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.live.drive_link import DriveLog
from slipwise.logs import open_log


def test_commands_and_poses_are_read_back_by_their_stamps(tmp_path: Path) -> None:
    log = DriveLog()
    for i in range(100):
        log.take_pose(10.0 + 0.1 * i, 0.05 * i, 0.0, 0.0)
    for i in range(200):
        log.take_command(10.0 + 0.05 * i, 0.5, 0.1)
    assert log.commands == 200
    file = tmp_path / "driven.csv"
    file.write_text(log.text(), encoding="utf-8")
    (run,) = open_log(file).runs
    assert run.commands is not None
    assert np.diff(run.commands.t).min() > 0.0
    assert (len(run.commands.t), len(run.poses.t)) == (200, 100)
    assert run.commands.v.tolist() == [0.5] * 200
    assert run.poses.x[-1] == 4.95

# SPDX-License-Identifier: Apache-2.0
"""A robot on ROS is read as its bag is: whether an attitude was measured, and which one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from live.test_ros_roles import Wire
from sample_logs import Drive, simulated_log

from slipwise.calibration.coming import coming_of
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.prepared_run import prepare_run
from slipwise.live.replay import samples_of
from slipwise.live.ros_robot import find_robot
from slipwise.live.samples import Pose, Sample
from slipwise.live.wires.wire import WireTopic
from slipwise.logs.bag_file import BagFile, bag_files
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Floats, Log
from slipwise.logs.open_log import open_log
from slipwise.logs.options import LogOptions
from slipwise.logs.save_log import save_log

OPTIONS = {"pose_topic": "/ground_truth/pose", "command_topic": "/cmd_vel", "wheel_topic": "none"}


class BagWire(Wire):
    """Hands over the messages of a bag, by topic."""

    def __init__(self, bag: Path) -> None:
        super().__init__({})
        with BagFile(bag, bag_files(bag), Tally()) as opened:
            self.found = [WireTopic(topic.name, topic.type, 1) for topic in opened.topics]
            for message in opened.messages({topic.name for topic in self.found}):
                self.messages.setdefault(message.topic, []).append(bytes(message.data))

    def topics(self) -> list[WireTopic]:
        return self.found


def bag_of(roll: Floats | None, pitch: Floats | None, folder: Path) -> Path:
    """Write a short drive with such an attitude, of a clock that ROS can have."""
    (run,) = simulated_log(Drive(seconds=8.0)).runs
    assert run.commands is not None
    count = len(run.poses)
    roll, pitch = (None if angle is None else np.resize(angle, count) for angle in (roll, pitch))
    poses = replace(run.poses, t=run.poses.t + 100.0, roll=roll, pitch=pitch)
    commands = replace(run.commands, t=run.commands.t + 100.0)
    save_log(Log((replace(run, commands=commands, wheels=None, poses=poses),)), folder / "drive.mcap")
    return folder / "drive.mcap"


def tilts(samples: list[Sample]) -> list[tuple[float | None, ...]]:
    return [(each.t, each.yaw, each.roll, each.pitch) for each in samples if isinstance(each, Pose)]


WAVE = 0.1 * np.sin(0.3 * np.arange(1.0, 800.0))
LATER = np.where(np.arange(799) < 2, 0.0, WAVE)  # the first two poses are level: a map begins with them


ATTITUDES: dict[str, tuple[Floats | None, Floats | None]] = {
    "level": (None, None),
    "roll alone": (WAVE, None),
    "pitch alone": (None, WAVE),
    "both": (WAVE, 0.5 * WAVE),
    "both later": (LATER, 2.0 * LATER),
}


@pytest.mark.parametrize("turned", [0.0, 0.5])
@pytest.mark.parametrize(("roll", "pitch"), ATTITUDES.values(), ids=ATTITUDES)
def test_a_robot_has_the_attitude_of_its_bag(
    roll: Floats | None, pitch: Floats | None, turned: float, tmp_path: Path
) -> None:
    bag = bag_of(roll, pitch, tmp_path)
    options = LogOptions.of({**OPTIONS, "pose_yaw_offset": turned})
    log = open_log(bag, options=options)
    robot = find_robot(BagWire(bag), LiveTable(), options, print, name="slipwise", simulated=False)
    found: list[Sample] = []
    robot.transport.subscribe(found.append)
    robot.transport.close()
    assert robot.coming.attitude == coming_of(log).attitude == (roll is not None and pitch is not None)
    (run,) = prepare_run(log, "command")
    assert tilts(found) == tilts(list(samples_of(run)))

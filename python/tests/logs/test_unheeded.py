# SPDX-License-Identifier: Apache-2.0
"""An option that a log of its kind has nothing of is refused, in place of doing nothing in silence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from slipwise.calibration import make_settings
from slipwise.errors import SettingsError
from slipwise.live.lines import LineReader
from slipwise.logs import LogOptions, open_log
from slipwise.logs.log import Source
from slipwise.logs.unheeded import kind_of, refuse_unheeded

ROWS = "t,cmd_v,cmd_omega,x,y,yaw\n" + "".join(f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,0\n" for k in range(9))
OF_BAGS: Mapping[str, object] = {
    "pose_topic": "/rtk",
    "command_topic": "none",
    "wheel_topic": "/odom",
    "imu_topic": "/imu",
    "pose_frame": "map",
    "child_frame": "base_link",
    "left_joints": ("left",),
    "right_joints": ("right",),
}


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "log.csv"
    path.write_text(ROWS, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", OF_BAGS)
def test_a_topic_of_a_table_or_of_lines_is_refused_by_its_option(name: str, table: Path) -> None:
    option = f"--{name.replace('_', '-')}"
    with pytest.raises(SettingsError, match=rf"^a table has nothing that it would choose \({option}\)"):
        open_log(table, **{name: OF_BAGS[name]})
    with pytest.raises(SettingsError, match=rf"stream of lines .*{option}"):
        LineReader(LogOptions.of({name: OF_BAGS[name]}))


def test_settings_of_a_robot_name_topics_for_its_bags_and_are_read_for_its_tables(table: Path) -> None:
    options = make_settings({"log": {"pose_topic": "/rtk", "command_scale": [2.0, 1.0]}}).log_options()
    (run,) = open_log(table, options=options).runs
    assert run.commands is not None
    assert run.commands.v[0] == 2.0


def test_joints_of_a_described_vehicle_are_not_refused(table: Path) -> None:
    assert open_log(table, vehicle="husky").runs


def of(form: str) -> str:
    return kind_of(Source("a file", "", form, 1))


def test_columns_of_a_bag_are_refused_unless_they_are_of_the_poses_beside_it() -> None:
    columns = LogOptions(columns={"t": "time"})
    with pytest.raises(SettingsError, match=r"a bag has nothing .*--columns"):
        refuse_unheeded(columns, of("mcap"))
    refuse_unheeded(columns, of("mcap"), of("csv"))
    refuse_unheeded(LogOptions(columns={"t": "time"}, poses=Path("p.csv")), of("mcap"))
    refuse_unheeded(LogOptions(pose_topic="XKF1"), of("dataflash"))
    with pytest.raises(SettingsError, match="--pose-topic"):
        refuse_unheeded(LogOptions(pose_topic="XKF1"), of("ulog"))


def test_what_takes_a_whole_log_is_refused_of_lines() -> None:
    for options in (LogOptions(poses=Path("p.csv")), LogOptions(start=1.0), LogOptions(end=5.0)):
        with pytest.raises(SettingsError, match="calibrate a recording with it"):
            LineReader(options)

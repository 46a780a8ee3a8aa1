# SPDX-License-Identifier: Apache-2.0
"""Tests of export.mounts: a transform, a URDF and settings, each read back."""

from __future__ import annotations

import re
import tomllib
import xml.etree.ElementTree as ET

import pytest
from sample_models import make_model, named

import slipwise as sw
from slipwise.errors import ModelError
from slipwise.export.mounts import mounts_text
from slipwise.models.mounted import Mounted

RTK = Mounted('/rtk "1"\n', (0.4512, 0.001), (-0.2, 0.001), (0.0348, 0.0003), (0.12, 0.001))


def test_each_part_of_the_file_is_read_back() -> None:
    text = mounts_text((RTK,), ("of a log",))
    _, transform, urdf, settings = text.split("\n# ")[-4:]
    assert "--x 0.4512 --y -0.2 --z 0 --yaw 0.0348 --frame-id base_link --child-frame-id rtk_1" in transform
    robot = ET.fromstring(f"<robot>{urdf.partition(':')[2]}</robot>")
    joint, origin = robot.find("joint"), robot.find("joint/origin")
    assert joint is not None
    assert origin is not None
    assert (joint.get("name"), joint.get("type")) == ("rtk_1_joint", "fixed")
    assert (origin.get("xyz"), origin.get("rpy")) == ("0.4512 -0.2 0", "0 0 0.0348")
    (table,) = tomllib.loads(settings.partition(":")[2])["pose_sources"]
    assert table == {"name": RTK.name, "x": 0.4512, "y": -0.2, "yaw": 0.0348, "late": 0.12}
    made = sw.make_settings({"pose_sources": [table]})
    assert made.pose_sources[0].x == 0.4512


def test_what_is_not_known_is_not_said() -> None:
    mount = Mounted("gnss", (0.3, 0.01), None, None)
    assert mount.sentence() == "gnss sits 0.300 ± 0.010 m ahead"
    assert not re.search("^(y|yaw) =", mounts_text((mount,), ()), re.MULTILINE)
    assert "# y and yaw of gnss not known: measure, and set: ros2 run" in mounts_text((mount,), ())
    (table,) = tomllib.loads(mounts_text((mount,), ()).rpartition("settings file:")[2])["pose_sources"]
    assert sw.make_settings({"pose_sources": [table]}).pose_sources[0].learns_place
    assert Mounted("gnss", None, None, None).sentence() == ""


def test_one_source_is_a_mount_only_where_the_user_says_so() -> None:
    slips = make_model(named("full-linear-6", lat__w=0.3, ang__w=-0.4))
    with pytest.raises(ModelError, match=r"does not tell side slip from a mount .*--no-side-slip"):
        sw.export_model(slips, "mounts", name="m", force=True)
    options = sw.ExportOptions(no_side_slip=True)
    made = sw.export_model(slips, "mounts", name="m", force=True, options=options)
    assert made.values == {"x": pytest.approx(0.5, abs=0.01)}  # 0.3 m/s to the left where it turns at 0.6
    assert tomllib.loads(made.text.rpartition("settings file:")[2])["sensor_extrinsics"]["x"] == 0.5
    straight = make_model(named("full-linear-6", ang__w=-0.4))
    with pytest.raises(ModelError, match="no part of the learned slip"):
        sw.export_model(straight, "mounts", name="m", force=True, options=options)

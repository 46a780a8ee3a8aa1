# SPDX-License-Identifier: Apache-2.0
"""Tests of export.mounts: a transform, a URDF and settings, each read back."""

from __future__ import annotations

import re
import tomllib
import xml.etree.ElementTree as ET

import pytest
from sample_models import make_model, named, with_further_sensors

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


def test_further_sources_are_written_from_the_model_file_alone() -> None:
    model = with_further_sensors(make_model(named("full-linear-6", lat__w=0.3, ang__w=-0.4)))
    made = sw.export_model(model, "mounts", name="m")
    assert made.values == {"/rtk x": 0.45, "/rtk y": -0.2}
    (table,) = tomllib.loads(made.text.rpartition("settings file:")[2])["pose_sources"]
    assert table == {"name": "/rtk", "x": 0.45, "y": -0.2, "late": 0.12}
    assert "gyro" not in made.text
    both = sw.export_model(model, "mounts", name="m", options=sw.ExportOptions(no_side_slip=True))
    assert list(both.values) == ["x", "/rtk x", "/rtk y"]


def test_a_filter_that_asks_tf_for_places_is_told_the_transform() -> None:
    plain = make_model(named("full-linear-6", lat__w=0.3, ang__w=-0.4))
    model = with_further_sensors(plain)
    ours, theirs = (sw.export_model(each, "robot-localization", name="m") for each in (model, plain))
    assert ours.values == theirs.values
    assert "# The filter has places of sensors from TF. /rtk sits 0.450 ± 0.010 m ahead" in ours.text
    assert "--x 0.45 --y -0.2 --z 0 --yaw 0 --frame-id base_link --child-frame-id rtk\n" in ours.text
    assert "from TF" not in theirs.text

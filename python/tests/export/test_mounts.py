# SPDX-License-Identifier: Apache-2.0
"""Tests of export.mounts: a transform, a URDF and settings, each read back."""

from __future__ import annotations

import re
import tomllib
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from sample_models import make_model, named

import slipwise as sw
from slipwise.calibration.mounts import Mount, holding_mounts
from slipwise.errors import ModelError
from slipwise.export.mounts import mounts_text
from slipwise.models.mounted import Mounted, mounts_in

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


@pytest.mark.parametrize(("identifiable", "turned"), [(True, 0.0), (True, 0.5), (False, 0.5)])
def test_a_further_source_is_placed_by_the_learned_place_of_the_first(
    identifiable: bool, turned: float
) -> None:
    """The rows of the second one were learned as if the first one sat in base_link, as the settings say."""
    first, second = np.array([0.4, 0.1]), np.array([-0.3, 0.2])
    cosine, sine = np.cos(turned), np.sin(turned)
    beside = np.array([[cosine, sine], [-sine, cosine]]) @ (second - first)
    made = replace(
        named("full-linear-6"), sensor_extrinsics=(*first, turned), std=0.003, identifiable=identifiable
    )
    rtk = Mount(
        "rtk", "lidar", np.array([*beside, -turned, 0.0]), np.diag([1e-6, 1e-6, 1e-6, 1e-6]), 100.0, True
    )
    model = holding_mounts(make_model(made), [rtk])
    (found,) = mounts_in(model)
    values = sw.export_model(model, "mounts", name="m", force=True).values
    if not identifiable:
        assert (found.x, found.y, found.yaw) == (None, None, None)
        assert not {"x", "rtk x", "rtk yaw"} & values.keys()
        return
    assert found.x is not None
    assert found.yaw == pytest.approx((0.0, 0.003), abs=1e-3)
    assert found.x == pytest.approx((second[0], 0.003), abs=1e-3)
    placed = {name: round(values[name], 4) for name in ("x", "y", "rtk x", "rtk y")}
    assert placed == {"x": 0.4, "y": 0.1, "rtk x": -0.3, "rtk y": 0.2}

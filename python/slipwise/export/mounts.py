# SPDX-License-Identifier: Apache-2.0
"""Where sensors sit, as a static transform, a URDF snippet and settings of slipwise."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from html import escape  # xml.sax.saxutils imports ssl

from slipwise.errors import ModelError
from slipwise.export.origin import one_line
from slipwise.models.model import Model
from slipwise.models.mounted import Estimate, Mounted, first_source, given_place
from slipwise.models.sensor_look import sensor_look

_FRAME = "pose_sensor"  # of a sensor without a name


def mount_of_look(model: Model) -> Mounted:
    """Return where the pose sensor sits on a robot that does not slip sideways, from what looks like that.

    Raises:
        ModelError: nothing of the slip looks like a sensor off the centre of turning.
    """
    if model.motion.slip_size == 0 or model.motion.sensor_extrinsics:
        raise ModelError(
            "the model has no slip that looks like a mount",
            advice="calibrate with a basis, and without sensor_extrinsics.learn",
        )
    look = sensor_look(model)
    known = [
        (given + look.pose[axis], look.std[axis]) if look.clear(axis) else None
        for axis, given in enumerate(given_place(model))
    ]
    if not any(known):
        raise ModelError(
            "no part of the learned slip is clearly what a sensor off the centre of turning looks like",
            advice="drive arcs of both hands, and turns in place",
        )
    x, y, yaw = known
    return Mounted(first_source(model) or _FRAME, x, y, yaw, first=True)


def mounts_text(mounts: Sequence[Mounted], origin: Sequence[str]) -> str:
    """Return the file: a static transform, a URDF snippet and settings of slipwise for each sensor."""
    lines = [f"# {one_line(line)}" for line in (*origin, *(mount.sentence() for mount in mounts))]
    lines += ["", "# ROS 2, static transforms:", *map(_transform, mounts)]
    lines += ["", "# URDF:", *(line for mount in mounts for line in _urdf(mount))]
    lines += ["", "# slipwise, in a settings file:", *(line for mount in mounts for line in _settings(mount))]
    return "\n".join(lines) + "\n"


def _value(estimate: Estimate | None) -> float:
    return 0.0 if estimate is None else round(estimate[0], 5) + 0.0


def _pose(mount: Mounted) -> tuple[float, float, float]:
    return _value(mount.x), _value(mount.y), _value(mount.yaw)


def frame_name(name: str) -> str:
    """Return a name of a frame: that of a topic without what frames cannot have."""
    return re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or _FRAME


def _unknown(mount: Mounted) -> str:
    """Say what is not known of where it sits; empty where all is."""
    names = (("x", mount.x), ("y", mount.y), ("yaw", mount.yaw))
    unknown = [name for name, estimate in names if estimate is None]
    return f"{' and '.join(unknown)} of {one_line(mount.name)} not known: measure, and set" if unknown else ""


def _transform(mount: Mounted) -> str:
    x, y, yaw = _pose(mount)
    unknown = _unknown(mount)
    return (f"# {unknown}: " if unknown else "") + (
        f"ros2 run tf2_ros static_transform_publisher --x {x:g} --y {y:g} --z 0 --yaw {yaw:g} "
        f"--frame-id base_link --child-frame-id {frame_name(mount.name)}"
    )


def _urdf(mount: Mounted) -> list[str]:
    x, y, yaw = _pose(mount)
    link = escape(frame_name(mount.name))
    unknown = re.sub("-{2,}", "-", _unknown(mount))  # which would end the comment
    return [
        *([f"<!-- {escape(unknown)} -->"] if unknown else []),
        f'<link name="{link}"/>',
        f'<joint name="{link}_joint" type="fixed">',
        '  <parent link="base_link"/>',
        f'  <child link="{link}"/>',
        f'  <origin xyz="{x:g} {y:g} 0" rpy="0 0 {yaw:g}"/>',
        "</joint>",
    ]


def _settings(mount: Mounted) -> list[str]:
    numbers = [
        f"{name} = {_value(estimate):g}"
        for name, estimate in (("x", mount.x), ("y", mount.y), ("yaw", mount.yaw))
        if estimate is not None
    ]
    if mount.first:
        return ["[sensor_extrinsics]", *numbers]
    late = [] if mount.late is None else [f"late = {_value(mount.late):g}"]
    rest = [] if len(numbers) == 3 else ["learn_extrinsics = true"]  # what is not known is not 0
    return ["[[pose_sources]]", f"name = {json.dumps(mount.name)}", *numbers, *rest, *late]

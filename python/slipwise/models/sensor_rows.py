# SPDX-License-Identifier: Apache-2.0
"""Rows of a model's table for sensors beside the first: their places, clocks and scales, each by its name.

They are learned apart from the motion, and nothing that predicts reads them.
"""

from __future__ import annotations

from collections.abc import Mapping

from slipwise.models.schema import Parameter, Stage

#: Kinds of a source of poses: its place in base_link.
PLACES = ("sensor_x", "sensor_y", "sensor_yaw")
#: How much later stamps are than those of the first source.
LATE = "late"
#: How far a gyro turns, over what the poses turn.
SCALE = "scale"
#: Stage and unit of each kind.
KINDS: Mapping[str, tuple[Stage, str]] = {
    "sensor_x": ("sensor", "m"),
    "sensor_y": ("sensor", "m"),
    "sensor_yaw": ("sensor", "rad"),
    LATE: ("clock", "s"),
    SCALE: ("sensor", "-"),
}


def sensor_row_name(kind: str, sensor: str) -> str:
    """Return the name of a row, such as `late(rtk)`."""
    return f"{kind}({sensor})"


def sensor_row(kind: str, sensor: str, estimate: tuple[float, float], prior_std: float) -> Parameter:
    """Return the row of a number that a drive tells of a sensor, with its standard deviation."""
    stage, unit = KINDS[kind]
    return Parameter(
        name=sensor_row_name(kind, sensor),
        stage=stage,
        unit=unit,
        value=estimate[0],
        std=estimate[1],
        prior_std=prior_std,
        identifiable=True,
        sensor=sensor,
    )


def is_sensor_row(row: Parameter) -> bool:
    """Whether a row that names a sensor is one of those above."""
    return any(
        row.name == sensor_row_name(kind, row.sensor) and (row.stage, row.unit) == made
        for kind, made in KINDS.items()
    )

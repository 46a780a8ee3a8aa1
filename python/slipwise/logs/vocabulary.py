# SPDX-License-Identifier: Apache-2.0
"""The words in which measurements are written down: the columns of a tidy log, and of a shared one."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from slipwise import _core

PREFIXES = ("wheel_", "steer_")  # of columns and joints, before the names of wheels and of steering joints


@dataclass(frozen=True)
class Column:
    """One column of a tidy log."""

    name: str
    of: str  # the measurement it is part of: command, wheel, pose, force, a reading, label; or time, run
    type: str  # string, number or integer, as a Table Schema calls them
    unit: str
    meaning: str
    marks: str = ""  # shared: a shared log may have it; always: in every row; text: tables may hold text here

    @property
    def shared(self) -> bool:
        """Whether a shared log may have it."""
        return "shared" in self.marks

    @property
    def always(self) -> bool:
        """Whether no cell of a shared log is empty."""
        return "always" in self.marks

    @property
    def text(self) -> bool:
        """Whether a table of any origin may hold text here."""
        return "text" in self.marks


COLUMNS = (
    Column(
        "run",
        "run",
        "string",
        "",
        "one uninterrupted recording; nothing is joined across runs",
        "shared always text",
    ),
    Column("t", "time", "number", "s", "stamp, strictly increasing within a run", "shared always"),
    Column("throttle", "command", "number", "1", "of a car, in [-1, 1]"),
    Column("steering", "command", "number", "1", "of a car, in [-1, 1], to the left"),
    Column(
        "cmd_v", "command", "number", "m/s", "commanded speed, forward; held until the next one", "shared"
    ),
    Column("cmd_vx", "command", "number", "m/s", "the same"),
    Column("cmd_vy", "command", "number", "m/s", "commanded speed, to the left", "shared"),
    Column("cmd_omega", "command", "number", "rad/s", "commanded yaw rate, counter-clockwise", "shared"),
    Column("cmd_curvature", "command", "number", "1/m", "commanded curvature"),
    Column("cmd_steer", "command", "number", "rad", "commanded steering angle"),
    Column(
        "cmd_ended",
        "command",
        "integer",
        "",
        "1 where nobody sent it: the command before is held, or zeros say that it ended",
        "shared",
    ),
    Column("cmd_dir", "command", "number", "rad", "commanded direction of travel, from the robot's x axis"),
    Column(
        "odo_v",
        "wheel",
        "number",
        "m/s",
        "forward speed measured at the wheels; held until the next one",
        "shared",
    ),
    Column("odo_vy", "wheel", "number", "m/s", "speed to the left measured at the wheels", "shared"),
    Column(
        "odo_omega",
        "wheel",
        "number",
        "rad/s",
        "yaw rate measured at the wheels, counter-clockwise",
        "shared",
    ),
    Column("wheel_left", "wheel", "number", "rad/s", "speed of the left wheels"),
    Column("wheel_right", "wheel", "number", "rad/s", "speed of the right wheels"),
    Column("x", "pose", "number", "m", "measured position in the frame", "shared"),
    Column("y", "pose", "number", "m", "measured position in the frame, to the left of x", "shared"),
    Column("yaw", "pose", "number", "rad", "measured heading, counter-clockwise from x", "shared"),
    Column("yaw_body", "pose", "number", "rad", "the body's heading, where yaw is the direction of travel"),
    Column("z", "pose", "number", "m", "measured height, up", "shared"),
    Column("roll", "pose", "number", "rad", "measured roll, right side down", "shared"),
    Column("pitch", "pose", "number", "rad", "measured pitch, nose down", "shared"),
    Column("std_xy", "pose", "number", "m", "standard deviation of x and of y", "shared"),
    Column("std_yaw", "pose", "number", "rad", "standard deviation of yaw", "shared"),
    Column("fix", "pose", "string", "", "what a satellite receiver says of the position", "text"),
    Column("force_x", "force", "number", "m/s^2", "a known force over the robot's mass along its x axis"),
    Column("force_y", "force", "number", "m/s^2", "the same to its left"),
    Column("source", "pose", "string", "", "which sensor measured the pose", "text"),
    Column(
        "pose_new", "pose", "integer", "", "1 where a pose was measured in this row, else 0", "shared always"
    ),
    Column(
        "frame", "pose", "integer", "", "poses are comparable only inside one frame of one run", "shared text"
    ),
    *(Column(kind.column, kind.sensor, "number", kind.unit, kind.meaning) for kind in _core.reading_kinds()),
    Column("terrain", "label", "string", "", "name of the surface from here on", "text"),
)
BY_NAME = {column.name: column for column in COLUMNS}
SHARED = tuple(column for column in COLUMNS if column.shared)
TEXT = tuple(column.name for column in COLUMNS if column.text)
NUMERIC = tuple(column.name for column in COLUMNS if not column.text and column.name != "pose_new")
POSE_COLUMNS = frozenset(column.name for column in COLUMNS if column.of == "pose")
_OTHER = "carried along; not used by the rules of scoring"


def measured_by(name: str, described: Collection[str] = ()) -> str:
    """Return which measurement a column is part of; empty where none is.

    Args:
        name: of the column.
        described: names of wheels and joints of the vehicle, as it is described.
    """
    if name in BY_NAME:
        return BY_NAME[name].of
    named = any(name in (each, *(prefix + each for prefix in PREFIXES)) for each in described)
    return "wheel" if named else ""


def table_schema(names: Sequence[str], numbers: Sequence[str]) -> dict[str, Any]:
    """Return a Frictionless Table Schema (v1) of columns in their order, with the unit of each.

    Args:
        names: the columns of the table.
        numbers: those beside the ones above that hold numbers.
    """
    fields = []
    for name in names:
        kind = "number" if name in numbers else "string"
        column = BY_NAME.get(name)
        if column is None or not column.shared:
            column = Column(name, "", kind, "" if column is None else column.unit, _OTHER)
        field: dict[str, Any] = {"name": name, "type": column.type, "description": column.meaning}
        if column.unit:
            field["unit"] = column.unit
        if column.always:
            field["constraints"] = {"required": True}
        fields.append(field)
    return {"fields": fields, "primaryKey": ["run", "t"], "missingValues": [""]}

# SPDX-License-Identifier: Apache-2.0
"""The columns of a shared log, stated once: type, unit and meaning, and their schema file for other tools."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class SharedColumn:
    """One column of a shared log."""

    name: str
    type: str  # string, number or integer, as a Table Schema calls them
    unit: str
    meaning: str
    always: bool = False  # no cell is empty


COLUMNS = (
    SharedColumn("run", "string", "", "one uninterrupted recording; nothing is joined across runs", True),
    SharedColumn("t", "number", "s", "stamp, strictly increasing within a run", True),
    SharedColumn("cmd_v", "number", "m/s", "commanded speed, forward; held until the next one"),
    SharedColumn("cmd_vy", "number", "m/s", "commanded speed, to the left"),
    SharedColumn("cmd_omega", "number", "rad/s", "commanded yaw rate, counter-clockwise"),
    SharedColumn("odo_v", "number", "m/s", "forward speed measured at the wheels; held until the next one"),
    SharedColumn("odo_vy", "number", "m/s", "speed to the left measured at the wheels"),
    SharedColumn("odo_omega", "number", "rad/s", "yaw rate measured at the wheels, counter-clockwise"),
    SharedColumn("x", "number", "m", "measured position in the frame"),
    SharedColumn("y", "number", "m", "measured position in the frame, to the left of x"),
    SharedColumn("yaw", "number", "rad", "measured heading, counter-clockwise from x"),
    SharedColumn("z", "number", "m", "measured height, up"),
    SharedColumn("roll", "number", "rad", "measured roll, right side down"),
    SharedColumn("pitch", "number", "rad", "measured pitch, nose down"),
    SharedColumn("std_xy", "number", "m", "standard deviation of x and of y"),
    SharedColumn("std_yaw", "number", "rad", "standard deviation of yaw"),
    SharedColumn("pose_new", "integer", "", "1 where a pose was measured in this row, else 0", True),
    SharedColumn("frame", "integer", "", "poses are comparable only inside one frame of one run"),
)
BY_NAME = {column.name: column for column in COLUMNS}
_OTHER = "carried along; not used by the rules of scoring"


def table_schema(names: Sequence[str], numbers: Sequence[str]) -> dict[str, Any]:
    """Return a Frictionless Table Schema (v1) of columns in their order, with the unit of each.

    Args:
        names: the columns of the table.
        numbers: those beside the ones above that hold numbers.
    """
    fields = []
    for name in names:
        kind = "number" if name in numbers else "string"
        column = BY_NAME.get(name) or SharedColumn(name, kind, "", _OTHER)
        field: dict[str, Any] = {"name": name, "type": column.type, "description": column.meaning}
        if column.unit:
            field["unit"] = column.unit
        if column.always:
            field["constraints"] = {"required": True}
        fields.append(field)
    return {"fields": fields, "primaryKey": ["run", "t"], "missingValues": [""]}

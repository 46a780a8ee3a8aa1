# SPDX-License-Identifier: Apache-2.0
"""Where further sensors sit and how late they are stamped: rows of a model's table, in words and back."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from slipwise.models.model import Model
from slipwise.models.schema import Parameter
from slipwise.models.sensor_rows import LATE, PLACES, sensor_row_name
from slipwise.number_text import estimate_text

Estimate = tuple[float, float]  # value and standard deviation


@dataclass(frozen=True)
class Mounted:
    """A sensor in base_link; None stands for what is not known."""

    name: str
    x: Estimate | None  # m ahead
    y: Estimate | None  # m to the left
    yaw: Estimate | None  # rad to the left
    late: Estimate | None = None  # s that its stamps are later than those of the first source
    first: bool = False  # whether it is the one of [sensor_extrinsics]

    @property
    def placed(self) -> bool:
        """Whether something is known of where it sits."""
        return any(each is not None for each in (self.x, self.y, self.yaw))

    def sentence(self) -> str:
        """Say where it sits; empty where nothing is known."""
        said = [
            f"{estimate_text(abs(place[0]), place[1])} m {plus if place[0] >= 0.0 else minus}"
            for place, plus, minus in ((self.x, "ahead", "behind"), (self.y, "to the left", "to the right"))
            if place is not None
        ]
        parts = [f"sits {' and '.join(said)}"] if said else []
        if self.yaw is not None:
            side = "left" if self.yaw[0] >= 0.0 else "right"
            degrees = estimate_text(math.degrees(abs(self.yaw[0])), math.degrees(self.yaw[1]))
            parts.append(f"is turned by {degrees} deg to the {side}")
        if self.late is not None:
            order = "later" if self.late[0] >= 0.0 else "earlier"
            parts.append(f"is stamped {estimate_text(abs(self.late[0]), self.late[1])} s {order}")
        return f"{self.name} {', '.join(parts)}" if parts else ""


def mounted_sensors(model: Model) -> tuple[Mounted, ...]:
    """Return where the further sensors of a model sit; none of a model of one source."""
    rows = {row.name: row for row in model.table.rows if row.sensor}
    names = dict.fromkeys(row.sensor for row in rows.values())
    return tuple(_mounted(name, rows) for name in names)


def mounted_sentences(sensors: Iterable[Mounted]) -> list[str]:
    """Say where further sensors sit, one sentence each."""
    return [
        f"{each.sentence()} than the first source." if each.late else f"{each.sentence()}."
        for each in sensors
    ]


def _mounted(name: str, rows: dict[str, Parameter]) -> Mounted:
    def of(kind: str) -> Estimate | None:
        row = rows.get(sensor_row_name(kind, name))
        return None if row is None else (row.value, row.std)

    x, y, yaw = (of(kind) for kind in PLACES)
    return Mounted(name, x, y, yaw, of(LATE))

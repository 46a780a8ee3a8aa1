# SPDX-License-Identifier: Apache-2.0
"""Where a sensor of poses sits in base_link, in words and as rows of a model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from slipwise.models.schema import Parameter
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from slipwise.models.model import Model

Estimate = tuple[float, float]  # value and standard deviation
Number = Literal["x", "y", "yaw", "late"]

#: Numbers of a mount in the order of their rows, with units.
UNITS: dict[Number, str] = {"x": "m", "y": "m", "yaw": "rad", "late": "s"}
#: In these units, the standard deviation up to which a number is said.
KNOWN = 0.1


@dataclass(frozen=True)
class Mounted:
    """A sensor in base_link; None stands for what is not known."""

    name: str
    x: Estimate | None  # m ahead
    y: Estimate | None  # m to the left
    yaw: Estimate | None  # rad to the left
    late: Estimate | None = None  # s that its stamps are later than those of the first source
    first: bool = False  # whether it is the one of [sensor_extrinsics]

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


def mount_row(name: str, beside: str, number: Number, estimate: Estimate, prior_std: float) -> Parameter:
    """Return the row of one number of a mount, which is known.

    Args:
        name: of the source of poses that it places.
        beside: name of the first source, from which it was learned; its own place and clock are the model's.
        number: which one.
        estimate: value and standard deviation.
        prior_std: what was known of it before.
    """
    where = f"{name} beside {beside}" if beside else name
    return Parameter(
        name=f"sensor_{number}({where})",
        stage="mount",
        unit=UNITS[number],
        value=estimate[0],
        std=estimate[1],
        prior_std=prior_std,
        identifiable=True,
        sensor=name,
        beside=beside,
    )


def mounts_in(model: Model) -> tuple[Mounted, ...]:
    """Return where further sources of poses sit, as a model holds it."""
    rows = model.table.of("mount").rows
    names = dict.fromkeys(row.sensor for row in rows)
    return tuple(_mounted(name, [row for row in rows if row.sensor == name]) for name in names)


def mount_sentences(model: Model) -> list[str]:
    """Say where each further source of poses sits."""
    beside = next((row.beside for row in model.table.rows if row.beside), "") or "the first source of poses"
    return [f"{found.sentence()}, beside {beside}." for found in mounts_in(model)]


def _mounted(name: str, rows: Sequence[Parameter]) -> Mounted:
    known = {row.name.partition("(")[0]: (row.value, row.std) for row in rows}
    x, y, yaw, late = (known.get(f"sensor_{number}") for number in UNITS)
    return Mounted(name, x, y, yaw, late)

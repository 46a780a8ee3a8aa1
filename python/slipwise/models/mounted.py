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


def mounts_in(model: Model, first: Mounted | None = None) -> tuple[Mounted, ...]:
    """Return where further sources of poses sit, as a model holds it.

    Args:
        model: its rows were learned as if the first source sat where the settings say.
        first: where that one sits; as the model learned it where this is None, else as the settings say.
    """
    rows = model.table.of("mount").rows
    names = dict.fromkeys(row.sensor for row in rows)
    found = tuple(_mounted(name, [row for row in rows if row.sensor == name]) for name in names)
    first = first or first_mount(model)
    return found if first is None else tuple(_moved(each, given_place(model), first) for each in found)


def first_mount(model: Model) -> Mounted | None:
    """Return where the first source of poses sits, as far as that was learned; None: as the settings say."""
    rows = [row for row in model.table.of("sensor").rows if row.name != "clock_offset" and row.identifiable]
    return _mounted(first_source(model), rows, first=True) if model.motion.sensor_extrinsics else None


def first_source(model: Model) -> str:
    """Return the name of the first source of poses where further ones were learned beside it; else none."""
    return next((row.beside for row in model.table.rows if row.beside), "")


def given_place(model: Model) -> tuple[float, float, float]:
    """Return where the settings say that the first source sits: x and y in m, yaw in rad."""
    settings = model.content.provenance.settings.get("sensor_extrinsics")
    given = settings if isinstance(settings, dict) else {}
    x, y, yaw = (float(given.get(name, 0.0)) for name in ("x", "y", "yaw"))
    return x, y, yaw


def mount_sentences(model: Model) -> list[str]:
    """Say where each further source of poses sits."""
    beside = first_source(model) or "the first source of poses"
    said = [mount.sentence() for mount in mounts_in(model)]
    return [f"In base_link {each}, by the place of {beside}." for each in said if each]


def _moved(mount: Mounted, given: tuple[float, float, float], first: Mounted) -> Mounted:
    """Return a sensor that was placed as if the first one sat at `given`, where that one sits at `first`."""
    to_x, to_y, to_yaw = (
        learned or (value, KNOWN) for learned, value in zip((first.x, first.y, first.yaw), given, strict=True)
    )
    turn = to_yaw[0] - given[2]
    cosine, sine = math.cos(turn), math.sin(turn)
    yaw = mount.yaw and (mount.yaw[0] + turn, math.hypot(mount.yaw[1], to_yaw[1]))
    x = y = None
    if mount.x is not None and mount.y is not None:
        ahead, left = mount.x[0] - given[0], mount.y[0] - given[1]
        ahead, left = cosine * ahead - sine * left, sine * ahead + cosine * left
        x_std, y_std = mount.x[1], mount.y[1]
        x = to_x[0] + ahead, math.hypot(to_x[1], cosine * x_std, sine * y_std, left * to_yaw[1])
        y = to_y[0] + left, math.hypot(to_y[1], sine * x_std, cosine * y_std, ahead * to_yaw[1])
    x, y, yaw = (each if each is not None and each[1] < KNOWN else None for each in (x, y, yaw))
    return Mounted(mount.name, x, y, yaw, mount.late)


def _mounted(name: str, rows: Sequence[Parameter], *, first: bool = False) -> Mounted:
    known = {row.name.partition("(")[0]: (row.value, row.std) for row in rows}
    x, y, yaw, late = (known.get(f"sensor_{number}") for number in UNITS)
    return Mounted(name, x, y, yaw, late, first)

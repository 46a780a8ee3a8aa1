# SPDX-License-Identifier: Apache-2.0
"""The parts of the C header that put commands behind the drive's limits, or let them pass as they are."""

from __future__ import annotations

import math
from importlib.resources import files

from slipwise import _core
from slipwise.models.limits import KINDS
from slipwise.models.model import Model
from slipwise.models.parameter_table import physical_name, physical_parameters
from slipwise.number_text import estimate_texts

_NONE = _core.AxisLimits()


def limits(model: Model) -> str:
    """Return the limits as constants, for the header itself and for the C++ library."""
    of_drive = model.limits or _core.CommandLimits(_NONE, _NONE, _NONE, 1.0, 1.0, 1.0)
    axes = {"SPEED": of_drive.speed, "YAW_RATE": of_drive.yaw_rate, "SIDE": of_drive.side}
    lines = [
        "/* Limits of the drive, before delay and lag: dead-band, saturation, slew rates, their lag. */",
        *_said(model),
    ]
    lines += [f"#define SLIPWISE_LIMITS_{name} {_axis(axis)}" for name, axis in axes.items()]
    lines += [
        f"#define SLIPWISE_LIMITS_WHEEL_SEPARATION SLIPWISE_R({of_drive.wheel_separation!r})  /* [m] */",
        f"#define SLIPWISE_LIMITS_GAIN_V SLIPWISE_R({of_drive.gain_v!r})  /* of what the sides are asked */",
        f"#define SLIPWISE_LIMITS_GAIN_OMEGA SLIPWISE_R({of_drive.gain_omega!r})",
        f"#define SLIPWISE_LIMITS_SIDES {int(_axis(of_drive.side) != _axis(_NONE))}",
    ]
    return "\n".join(lines)


def how_known(model: Model) -> dict[str, str]:
    """Return how well each learned number is known, as the end of a comment, by names without `log_`.

    A number that is not identified stays in the header, which predicts what the model does; it says so.
    """
    not_identifiable = {physical_name(row.name) for row in model.table.rows if not row.identifiable}
    return {
        p.name: f", {' +- '.join(estimate_texts(p.value, p.std))}"
        + ("" if p.identified and p.name not in not_identifiable else ", not identified")
        for p in physical_parameters(model)
    }


def _said(model: Model) -> list[str]:
    how = how_known(model)
    return [f"/* {name}{text} */" for name, text in how.items() if name.startswith("limits.")]


def cursor(model: Model) -> str:
    """Return how the header walks over the commands: with their limits, where there are some."""
    name = "cursor_template.h" if model.limits is None else "limits_template.h"
    text = files("slipwise.export").joinpath(name).read_text(encoding="utf-8")
    return text.replace("@PIECE@", repr(_core.RAMP_PIECE))


def _axis(axis: _core.AxisLimits) -> str:
    values: list[float] = [getattr(axis, name) for name in KINDS]
    return ", ".join("INFINITY" if math.isinf(value) else repr(value) for value in values)

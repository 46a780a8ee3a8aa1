# SPDX-License-Identifier: Apache-2.0
"""The limits of a drive in a model: for the core, and in rows of numbers."""

from __future__ import annotations

import math

from slipwise import _core
from slipwise.models.schema import AxisLimitsSection, LearnedLimit, LimitsSection

AXES = ("speed", "yaw_rate", "side")
KINDS = ("dead_band", "saturation", "slew_rate_up", "slew_rate_down")
_AXIS_UNITS = {"speed": "m/s", "yaw_rate": "rad/s", "side": "m/s"}
_CORE_AXES = dict(
    zip(AXES, (_core.LimitedAxis.Speed, _core.LimitedAxis.YawRate, _core.LimitedAxis.Side), strict=True)
)
_CORE_KINDS = dict(
    zip(
        KINDS,
        (
            _core.LimitKind.DeadBand,
            _core.LimitKind.Saturation,
            _core.LimitKind.SlewRateUp,
            _core.LimitKind.SlewRateDown,
        ),
        strict=True,
    )
)


def limits_section(search: _core.LimitSearch) -> LimitsSection:
    """Return what a search found as the section of a model file."""
    found = {(limit.axis, limit.kind): limit for limit in search.found}

    def learned(axis: str, kind: str) -> LearnedLimit | None:
        limit = found.get((_CORE_AXES[axis], _CORE_KINDS[kind]))
        return None if limit is None else LearnedLimit(value=limit.value, std=limit.std)

    axes = {axis: AxisLimitsSection(**{kind: learned(axis, kind) for kind in KINDS}) for axis in AXES}
    limits = search.limits
    return LimitsSection(
        **axes,
        wheel_separation=limits.wheel_separation,
        wheel_separation_std=search.wheel_separation_std,
        gain_v=limits.gain_v,
        gain_omega=limits.gain_omega,
    )


def core_limits(section: LimitsSection) -> _core.CommandLimits:
    """Return the limits for the core."""

    def axis(name: str) -> _core.AxisLimits:
        limits: AxisLimitsSection = getattr(section, name)
        values = {kind: getattr(limits, kind) for kind in KINDS}
        absent = {"dead_band": 0.0}
        return _core.AxisLimits(
            **{k: absent.get(k, math.inf) if v is None else v.value for k, v in values.items()}
        )

    return _core.CommandLimits(
        axis("speed"),
        axis("yaw_rate"),
        axis("side"),
        section.wheel_separation,
        section.gain_v,
        section.gain_omega,
    )


def limit_rows(section: LimitsSection) -> list[tuple[str, float, float, str]]:
    """Return name, value, standard deviation and unit of every limit."""
    rows = []
    for axis in AXES:
        for kind in KINDS:
            limit: LearnedLimit | None = getattr(getattr(section, axis), kind)
            if limit is not None:
                unit = _AXIS_UNITS[axis] + ("^2" if kind in ("slew_rate_up", "slew_rate_down") else "")
                rows.append((f"limits.{axis}.{kind}", limit.value, limit.std, unit))
    if any(name.startswith("limits.side") for name, *_ in rows):
        rows.append(("limits.wheel_separation", section.wheel_separation, section.wheel_separation_std, "m"))
    return rows

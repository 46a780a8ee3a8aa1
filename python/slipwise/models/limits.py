# SPDX-License-Identifier: Apache-2.0
"""The limits of a drive: as rows of a model's parameters, by axis and kind, and for the core."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from slipwise import _core
from slipwise.models.schema import NotNegative, Parameter, Positive, Section

AXES = ("speed", "yaw_rate", "side")
KINDS = {row.name: row for row in _core.limit_rows()}
SEPARATION = "limits.wheel_separation"
_AXIS_UNITS = {"speed": "m/s", "yaw_rate": "rad/s", "side": "m/s"}
_CORE_AXES = dict(
    zip(AXES, (_core.LimitedAxis.Speed, _core.LimitedAxis.YawRate, _core.LimitedAxis.Side), strict=True)
)


class LearnedLimit(Section):
    """One limit of the drive, the same for both signs."""

    value: Positive  # [m/s or rad/s; rates m/s^2 or rad/s^2; s]
    std: NotNegative


class AxisLimitsSection(Section):
    """Limits of one axis; what the log did not show is absent, and not limited."""

    dead_band: LearnedLimit | None = None  # what is slower gives zero, the rest passes as it is
    saturation: LearnedLimit | None = None  # no faster
    slew_rate_up: LearnedLimit | None = None  # away from zero no quicker
    slew_rate_down: LearnedLimit | None = None  # towards zero no quicker
    slew_rate_lag: LearnedLimit | None = None  # both of the drive behind this lag, not of its commands


class LimitsSection(Section):
    """Limits before delay and lag: of the commands, then of each side's speed, v -+ w separation / 2."""

    speed: AxisLimitsSection
    yaw_rate: AxisLimitsSection
    side: AxisLimitsSection
    wheel_separation: Positive  # [m]; without limits of the sides it has no effect, nor have the gains
    wheel_separation_std: NotNegative
    gain_v: Positive  # of what is asked of the sides over the limited command [-]
    gain_omega: Positive  # [-]


def limits_section(search: _core.LimitSearch) -> LimitsSection:
    """Return what a search found, by axis and kind."""
    found = {(limit.axis, limit.kind.name): limit for limit in search.found}

    def learned(axis: str, kind: str) -> LearnedLimit | None:
        limit = found.get((_CORE_AXES[axis], kind))
        return None if limit is None else LearnedLimit(value=limit.value, std=limit.std)

    limits = search.limits
    apart = LearnedLimit(value=limits.wheel_separation, std=search.wheel_separation_std)
    return _section(learned, apart, (limits.gain_v, limits.gain_omega))


def _section(
    learned: Callable[[str, str], LearnedLimit | None], apart: LearnedLimit, gains: Sequence[float]
) -> LimitsSection:
    """Return what was learned of each axis and kind, between wheels that are so far `apart`."""
    return LimitsSection(
        **{axis: AxisLimitsSection(**{kind: learned(axis, kind) for kind in KINDS}) for axis in AXES},
        wheel_separation=apart.value,
        wheel_separation_std=apart.std,
        gain_v=gains[0],
        gain_omega=gains[1],
    )


def limit_rows(section: LimitsSection) -> list[Parameter]:
    """Return limits as rows of a model's parameters; each is known by itself."""
    rows = []
    for axis in AXES:
        for kind, row in KINDS.items():
            limit: LearnedLimit | None = getattr(getattr(section, axis), kind)
            if limit is not None:
                unit = "s" if row.per_second < 0 else _AXIS_UNITS[axis] + ("^2" if row.per_second else "")
                rows.append(_row(f"limits.{axis}.{kind}", unit, limit.value, limit.std))
    if any(row.name.startswith("limits.side") for row in rows):
        rows.append(_row(SEPARATION, "m", section.wheel_separation, section.wheel_separation_std))
    return rows


def _row(name: str, unit: str, value: float, std: float) -> Parameter:
    """A limit was looked for from nothing: as if it had been known to its own size before."""
    return Parameter(
        name=name,
        stage="limits",
        unit=unit,
        value=value,
        std=std,
        prior_std=value,
        identifiable=2.0 * std * std <= value * value,
    )


def limits_of(rows: Iterable[Parameter], gains: Sequence[float] | None) -> LimitsSection | None:
    """Return the limits among the rows of a model's parameters, by axis and kind; None where there are none.

    Raises:
        ValueError: there is no such limit, or one is not positive.
    """
    found = {row.name: row for row in rows if row.stage == "limits"}
    if not found or gains is None:
        return None

    def learned(name: str) -> LearnedLimit | None:
        row = found.pop(name, None)
        return None if row is None else LearnedLimit(value=row.value, std=row.std)

    apart = learned(SEPARATION) or LearnedLimit(value=1.0, std=0.0)
    section = _section(lambda axis, kind: learned(f"limits.{axis}.{kind}"), apart, gains)
    if found:
        raise ValueError(f"no drive has a limit {', '.join(found)}")
    return section


def core_limits(section: LimitsSection) -> _core.CommandLimits:
    """Return the limits for the core."""

    def axis(name: str) -> _core.AxisLimits:
        limits: AxisLimitsSection = getattr(section, name)
        values = {kind: getattr(limits, kind) for kind in KINDS}
        return _core.AxisLimits(**{k: v.value for k, v in values.items() if v is not None})

    return _core.CommandLimits(
        axis("speed"),
        axis("yaw_rate"),
        axis("side"),
        section.wheel_separation,
        section.gain_v,
        section.gain_omega,
    )

# SPDX-License-Identifier: Apache-2.0
"""Learned limits of the drive among the parameters of Nav2's MPPI controller."""

from __future__ import annotations

from slipwise.export.parameter_file import Entry
from slipwise.models.schema import LearnedLimit, LimitsSection

_SIDES = "Limits of the sides are not among them: MPPI has none. Keep speed and turning together below them."


def with_limits(
    entries: list[Entry], limits: LimitsSection | None, gains: tuple[float, float]
) -> list[Entry]:
    """Return the entries with learned tops and rates in them; `gains` are the body's over the commands."""
    if limits is None:
        return entries
    known = {entry.key: entry for entry in entries}
    for name, top, kind in (("vx_max", limits.speed.top, 1.0), ("vx_min", limits.speed.top, -1.0)):
        _cap(known, name, top, kind * gains[0])
    _cap(known, "wz_max", limits.yaw_rate.top, gains[1])
    _cap(known, "ax_max", limits.speed.acceleration, gains[0])
    _cap(known, "ax_min", limits.speed.braking, -gains[0])
    _cap(known, "az_max", limits.yaw_rate.acceleration, gains[1])
    dead = (limits.speed.dead_band, limits.yaw_rate.dead_band)
    if any(band is not None for band in dead):
        speed, turn = (0.0 if band is None else band.value for band in dead)
        key = ("VelocityDeadbandCritic", "deadband_velocities")
        known[key] = Entry(key, [speed, 0.0, turn], "[m/s, m/s, rad/s] commands that are slower give zero")
    return list(known.values())


def _cap(known: dict[tuple[str, ...], Entry], name: str, limit: LearnedLimit | None, gain: float) -> None:
    """Put a learned limit in, unless what is there already is stricter."""
    key = (name,)
    if limit is None:
        return
    value, there = gain * limit.value, known.get(key)
    if there is None or abs(value) < abs(float(str(there.value))):
        known[key] = Entry(key, value, f"learned: the drive's limit, +- {abs(gain) * limit.std:.2g}")


def dead_band_notes(limits: LimitsSection | None) -> list[str]:
    """Return what the file's reader must know of limits."""
    if limits is None:
        return ["The model has no dead-band: VelocityDeadbandCritic is left as it is."]
    notes = []
    if limits.speed.dead_band is None and limits.yaw_rate.dead_band is None:
        notes.append("No dead-band of commands was learned: VelocityDeadbandCritic is left as it is.")
    if any(value is not None for _, value in limits.side):
        notes.append(_SIDES)
    return notes

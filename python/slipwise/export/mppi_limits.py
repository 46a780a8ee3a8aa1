# SPDX-License-Identifier: Apache-2.0
"""Dead bands among the parameters of Nav2's MPPI controller, and what its file says of limits."""

from __future__ import annotations

from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.parameter_file import Entry, Kept
from slipwise.models.limits import LimitsSection

_DEAD_BANDS = ("VelocityDeadbandCritic", "deadband_velocities")
_SIDES = """\
Limits of the sides bound speed and turning together; here each is bounded as if the robot did only that.
Where it does both, keep below them by yourself."""


def dead_bands(limits: LimitsSection | None, numbers: LearnedNumbers) -> list[Entry | Kept]:
    """Return the speeds below which commands give nothing; zero, Nav2's own, where none is known."""
    bands = () if limits is None else (limits.speed.dead_band, limits.yaw_rate.dead_band)
    known = [None if band is None else numbers.limit(band) for band in bands]
    objections = [numbers.objection(band) for band in known if band is not None]
    if not objections:
        return []
    if all(objections):
        return [Kept(_DEAD_BANDS, objections[0])]
    speed, turn = (0.0 if band is None or numbers.objection(band) else band.value for band in known)
    meaning = "[m/s, m/s, rad/s] commands that are slower give zero"
    return [Entry(_DEAD_BANDS, [speed, 0.0, turn], "\n".join((meaning, *filter(None, objections))))]


def limit_notes(limits: LimitsSection | None) -> list[str]:
    """Return what the file's reader must know of limits."""
    if limits is None:
        return ["The model has no dead-band: VelocityDeadbandCritic is left as it is."]
    notes = []
    if limits.speed.dead_band is None and limits.yaw_rate.dead_band is None:
        notes.append("No dead-band of commands was learned: VelocityDeadbandCritic is left as it is.")
    if any(value is not None for _, value in limits.side):
        notes.append(_SIDES)
    return notes

# SPDX-License-Identifier: Apache-2.0
"""What a log holds and learning does not use, in sentences: nothing is left out unsaid."""

from __future__ import annotations

from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.sloping_ground import has_attitude, has_known_force
from slipwise.logs.log import Log
from slipwise.segments import source_names


def unused_measurements(log: Log, settings: Settings, *, smooth: bool) -> tuple[str, ...]:
    """Return sentences on what the log has beside what is learned from, and what to do."""
    said = []
    names = source_names(log.runs)
    others = ", ".join(names[1:])
    if len(names) > 1 and settings.estimator != AVERAGE:
        said.append(
            f"{settings.estimator} learns from the poses of {names[0]} alone; those of {others} are not "
            f"used: estimator = '{AVERAGE}' uses all"
        )
    if len(names) > 1 and smooth:
        said.append(f"smoothed slip is of the poses of {names[0]} alone; those of {others} are not used")
    if any(run.commands is not None and run.commands.car is not None for run in log.runs):
        what = "known forces" if has_known_force(log) else "roll and pitch" if has_attitude(log) else ""
        if what:
            said.append(
                f"{what} are not used: a model of throttle and steering has no slip that gravity or a force "
                "causes; where they matter, calibrate from measured speeds with --input wheel"
            )
    return tuple(said)

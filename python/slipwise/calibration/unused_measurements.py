# SPDX-License-Identifier: Apache-2.0
"""What a log holds and learning does not use, in sentences: nothing is left out unsaid."""

from __future__ import annotations

from slipwise.calibration.learner import BASELINE, DIRECT, JOINT, LIMITS, Posterior
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.sloping_ground import has_attitude, has_known_force
from slipwise.logs.log import Log
from slipwise.segments import source_names

_STRUCTURES = {
    JOINT: "slip with lag and delay",
    LIMITS: "slip with lag and delay",
    DIRECT: "slip with a delay",
    BASELINE: "the kinematic baseline",
}


def unused_wheels(log: Log, settings: Settings, kept: Posterior, input_name: str) -> tuple[str, ...]:
    """Say why a model of commands does not use the wheel speeds of its log; an empty tuple where it does.

    Args:
        log: what was learned.
        settings: that it was learned with.
        kept: what was learned.
        input_name: "command" or "wheel", what it was learned from.
    """
    with_wheels = sum(run.wheels is not None and len(run.wheels) > 1 for run in log.runs)
    if input_name != "command" or not with_wheels or kept.motion.response:
        return ()
    if any(run.commands is not None and run.commands.car is not None for run in log.runs):
        why = "curves of throttle and steering are learned from poses alone"
    elif settings.estimator != AVERAGE:
        why = f"{settings.estimator} learns from commands alone"
    elif settings.basis != "auto":
        why = f"only basis auto also learns by way of the wheels, and it is {settings.basis}"
    elif "cascaded" not in settings.auto.structures:
        why = "auto.structures leaves cascaded out"
    else:
        why = f"{_STRUCTURES[kept.structure]} predicts better"
        if with_wheels < len(log.runs):
            why += f", and {with_wheels} of {len(log.runs)} runs have some"
    return (f"From commands, wheel speeds are not used: {why}.",)


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

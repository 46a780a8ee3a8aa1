# SPDX-License-Identifier: Apache-2.0
"""Why a log has too few segments to judge a model by, and what of a log learning does not use."""

from __future__ import annotations

from slipwise.calibration.judgement import FEWEST_WINDOWS
from slipwise.calibration.learner import BASELINE, DIRECT, JOINT, LIMITS, Posterior
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.settings_for_log import has_attitude, has_known_force
from slipwise.errors import LogError
from slipwise.logs.findings.command_stops import stops_of
from slipwise.logs.log import Log
from slipwise.models.inputs import INPUT_NAMES
from slipwise.segments import source_names

NEEDED = 2 * FEWEST_WINDOWS  # segments, half of which are held out
_NAMES = {"command": "commands", "wheel": "wheel speeds"}
_CURES = {
    "late-pose": "record poses at a steady rate",
    "unknown-input": "record the inputs without gaps, or raise unknown_after under [segment]",
    "standing-still": "drive for more of the time",
    "heading-ambiguous": "record poses more often, or turn more slowly",
}
_STRUCTURES = {
    JOINT: "slip with lag and delay",
    LIMITS: "slip with lag and delay",
    DIRECT: "slip with a delay",
    BASELINE: "the kinematic baseline",
}


def shortage_advice(log: Log, input_name: str, shortest: WindowSet, settings: Settings) -> tuple[str, ...]:
    """Say what to do about too few segments.

    Args:
        log: the data to learn from.
        input_name: the input that is learned from.
        shortest: the segments of the shortest horizon that is judged.
        settings: those of learning.
    """
    silent = silence(shortest)
    advice = [] if silent is None else [f"{silent[0][0].upper()}{silent[0][1:]}.", silent[1]]
    advice += [
        f"Rejected: {item.count} x {item.reason}; {_CURES[item.kind]}."
        for item in sorted(shortest.left_out, key=lambda item: -item.count)
        if item.count >= FEWEST_WINDOWS and item.kind in _CURES
    ]
    for other in INPUT_NAMES:
        count = 0 if other == input_name else _segments(log, other, shortest.length, settings)
        if count >= NEEDED:
            advice.append(f"From {_NAMES[other]} the log has {count} segments: use --input {other}.")
    advice.append(
        f"Record a drive of some minutes with poses and {_NAMES[input_name]} all along: at the very least "
        f"{NEEDED} segments of {shortest.length:g} s, where this log has {len(shortest)}."
    )
    return tuple(advice)


def silence(windows: WindowSet) -> tuple[str, str] | None:
    """Say how rarely commands come, where they do, and what to do about it."""
    if windows.drive[0].input_name != "command":
        return None
    pairs = [(run.inputs, run.run.poses) for run in windows.drive]
    return stops_of(pairs).words(windows.unknown_after)


def _segments(log: Log, input_name: str, length: float, settings: Settings) -> int:
    try:
        return len(collect_windows(prepare_run(log, input_name), length, settings.rules()))
    except LogError:
        return 0


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
    use = "only say how the robot drives when a prediction starts"
    if any(run.commands is not None and run.commands.car is not None for run in log.runs):
        use, why = "are not used", "curves of throttle and steering are learned from poses alone"
    elif settings.estimator != AVERAGE:
        use, why = "are not used", f"{settings.estimator} learns from commands alone"
    elif "cascaded" not in settings.auto.structures:
        why = "auto.structures leaves cascaded out"
    else:
        why = f"{_STRUCTURES[kept.structure]} predicts better"
        if with_wheels < len(log.runs):
            why += f", and {with_wheels} of {len(log.runs)} runs have some"
    return (f"From commands, wheel speeds {use}: {why}.",)


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

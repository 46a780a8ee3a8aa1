# SPDX-License-Identifier: Apache-2.0
"""Judges a whole log after reading: refuses contradictions and takes out pose jumps, all counted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise import _core
from slipwise.logs.attitude import levelled
from slipwise.logs.findings.course_heading import as_positions, is_course
from slipwise.logs.findings.encoders import WheelSpikes
from slipwise.logs.findings.finding import Finding, RefusedLogError
from slipwise.logs.findings.plausibility import Implausible, UnreachablePoses, agreement
from slipwise.logs.findings.readings import NotInSeconds
from slipwise.logs.findings.seen import OTHER, WORDS
from slipwise.logs.findings.wheel_layout import OF_LAYOUTS
from slipwise.logs.findings.wheel_twists import DeadWheel
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.left_out import Tally, samples_left_out
from slipwise.logs.log import Bools, Floats, Inputs, Ints, LeftOut, Log, Poses, Run, has_course
from slipwise.logs.motion_windows import evidence_of, measured_rows, motion_windows
from slipwise.logs.stamps import BACKWARD

_HARDLY = 10.0  # times as many poses out of order as in order
_FEW = 20  # steps; with fewer no such judgement is made


def checked(log: Log, unknown_after: float = UNKNOWN_AFTER) -> Log:
    """Return the log without pose jumps and with the attitude of the robot.

    Args:
        log: as it was read.
        unknown_after: an input is unknown once it is older than this [s].

    Raises:
        LogError: poses and inputs contradict each other, or units are wrong.
    """
    where = log.sources[0].path if log.sources else ""
    log = levelled(log)
    _check_forward(log, where)
    steps = [np.empty(0), *(np.diff(run.poses.t) for run in log.runs)]
    _refuse(NotInSeconds.by(np.concatenate(steps)), where)
    rows = measured_rows(log.runs, unknown_after)
    agreed = {name: agreement(motion_windows(rows, name)) for name in ("command", "wheel")}
    for name, own in agreed.items():
        odd = Implausible.of(own, WORDS[name], agreed[OTHER[name]])
        cause = None if odd is None else _cause(log, rows, name)
        _refuse(cause or odd, where)
    runs, found = _smoothed(log, unknown_after)
    if _heads_along_course(runs, unknown_after):
        log = as_positions(log)
        runs, found = _smoothed(log, unknown_after)
    jumping, count = sum(entry.count for entry in found), sum(max(len(run.poses) - 1, 0) for run in log.runs)
    _refuse(UnreachablePoses.of(jumping, count), where)
    return replace(log, runs=runs, left_out=log.left_out + found)


def _smoothed(log: Log, unknown_after: float) -> tuple[tuple[Run, ...], tuple[LeftOut, ...]]:
    """Return the runs without pose jumps, and what was left out."""
    tally = Tally()
    runs = tuple(_smooth(run, unknown_after, tally) for run in log.runs)
    return runs, tally.result()


def _heads_along_course(runs: tuple[Run, ...], unknown_after: float) -> bool:
    """Whether headings are a course over ground: they turn about where the robot reverses."""
    if has_course(runs):
        return False
    name = "wheel" if any(run.wheels is not None for run in runs) else "command"
    return is_course(motion_windows(evidence_of(runs, unknown_after).windows, name))


def _cause(log: Log, rows: Floats, name: str) -> Finding | None:
    """Find what is wrong with encoders, which makes units and columns of the wheels look wrong."""
    layout = next((each for each in log.found if each.kind in OF_LAYOUTS), None)
    if layout is not None or name != "wheel":
        return layout
    return DeadWheel.of(motion_windows(rows, "wheel")) or WheelSpikes.kept(log)


def _check_forward(log: Log, where: str) -> None:
    """Refuse a log in which hardly any pose is later than those before it: its stamps are no times."""
    kept = sum(len(run.poses) for run in log.runs)
    rejected = samples_left_out(log, "poses", "duplicate-stamp", BACKWARD)
    if rejected >= _FEW and rejected > _HARDLY * kept:
        what = f"stamps do not go forward in {rejected} of {kept + rejected} poses"
        advice = "give each measurement its own time, in seconds"
        raise RefusedLogError(NotInSeconds.found(what, advice, evidence=rejected), where)


def _refuse(odd: Finding | None, where: str) -> None:
    if odd is not None:
        raise RefusedLogError(odd, where)


def _smooth(run: Run, unknown_after: float, tally: Tally) -> Run:
    inputs = run.wheels if run.wheels is not None else run.commands
    if inputs is None or len(run.poses) < 2:
        return run
    jumps = find_jumps(run.poses, inputs, unknown_after)
    if not (jumps.dropped.any() or jumps.starts.any()):
        return run
    for flags, kind, reason in (
        (jumps.dropped, "pose-outlier", "poses far from their neighbours"),
        (jumps.starts, "pose-jump", "steps between poses that jump; poses after are in a frame of their own"),
    ):
        first = float(run.poses.t[np.argmax(flags)])
        tally.add(kind, reason, count=int(flags.sum()), where=run.place(first))
    return replace(run, poses=without_jumps(run.poses, jumps))


@dataclass(frozen=True, eq=False)
class Jumps:
    """What was found: poses to drop, poses that start a new frame, and the frames of those that stay."""

    dropped: Bools  # [M]
    starts: Bools  # [M]
    frame: Ints  # [M] of the poses; meaningless where they are dropped


def find_jumps(poses: Poses, inputs: Inputs, unknown_after: float) -> Jumps:
    """Find jumps as the learner does while it drives: from what was measured until then.

    An input is unknown once it is older than `unknown_after` [s].
    """
    recording = _core.Recording(np.empty((0, 4)), inputs.rows(), np.empty((0, 3)), poses.rows())
    gated = _core.gate_poses(recording, unknown_after)
    accepted = np.asarray(gated.accepted)
    frame = np.zeros(len(poses), dtype=np.int64)
    frame[_places(poses, accepted[:, 0])] = accepted[:, 4].astype(np.int64)
    dropped, starts = np.zeros(len(poses), bool), np.zeros(len(poses), bool)
    dropped[_places(poses, np.asarray(gated.outliers)[:, 0])] = True
    starts[_places(poses, np.asarray(gated.jumps)[:, 0])] = True
    return Jumps(dropped, starts, frame)


def _places(poses: Poses, stamps: Floats) -> Ints:
    """Return where poses with these stamps are."""
    return np.asarray(np.searchsorted(poses.t, stamps), dtype=np.int64)


def without_jumps(poses: Poses, jumps: Jumps) -> Poses:
    """Drop the lone outliers, and give the poses after each lasting jump a frame of their own.

    The poses as measured go along: a learner finds the jumps when it would have on a robot.
    """
    keep = ~jumps.dropped
    clean = replace(poses.select(keep), frame=jumps.frame[keep])
    object.__setattr__(clean, "measured", poses)
    return clean

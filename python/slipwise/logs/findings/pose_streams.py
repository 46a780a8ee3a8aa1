# SPDX-License-Identifier: Apache-2.0
"""Finds poses that stand still or stay away while the robot drives, and poses on another clock."""

from __future__ import annotations

import itertools

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.seen import WORDS, WholeLog
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Floats, Inputs, Poses, Run
from slipwise.logs.pose_clock import agreements, pose_motion

_LONG = 3.0  # s, and as many usual steps,
_STEPS = 20.0
_DRIVEN = 0.5  # m by the inputs, or as much of a turn
_ARM = 0.3  # m at which a turn counts as distance
_FAR = 3.0  # s in which another clock is looked for
_OFFSETS = np.arange(-_FAR, _FAR + 0.05, 0.1)  # s
_APART = {"wheel": (-0.6, 0.5), "command": (-1.8, 0.3)}  # s added to poses; drives answer commands late
_FIT, _BETTER = 0.7, 0.15  # least agreement at another clock, and by how much it beats none


class FrozenPoses(Check):
    """Poses that repeat, or do not come, while the inputs drive."""

    kind, family, spoils = "frozen-poses", "poses", False
    of_input = True
    hidden_by = ("two-sources", "repeated-wheels")
    means = "the localiser froze: it repeats a pose to the last digit, or sends none, while the robot drives"
    shows = "3 s and more of it while the inputs drive 0.5 m"
    cure = "look at the localiser at that time; `--start`, `--end` leave it out"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look for stretches without a new pose."""
        found = [stretch for run in whole.log.runs for stretch in _frozen(run, whole)]
        if not found:
            return None
        longest = max(found)
        total = sum(seconds for seconds, _ in found)
        return self.found(
            f"no new pose came for {total:.1f} s in which the inputs drive, for {longest[0]:.1f} s from "
            f"{longest[1]}: the localiser froze, or lost the robot",
            "Look at the localiser at that time; --start and --end leave it out.",
            evidence=total,
        )


class ClockOffset(Check):
    """Poses whose motion fits that of the inputs far better at another time."""

    kind, family, spoils = "clock-offset", "clocks", False
    means = "poses and inputs are on clocks that are apart, or one of them waits in a queue"
    shows = "both agree best with poses 0.6 s earlier or 0.5 s later and more (commands: 1.8 s, 0.3 s)"
    cure = "`--pose-clock-offset auto`; stamp poses when they are measured"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Try offsets of 3 s either way."""
        name = told_by(whole)
        runs = [run for run in whole.log.runs if len(run.poses) > 1 and inputs_of(run, name) is not None]
        poses = [run.poses for run in runs]
        if not poses or any(a.t[-1] >= b.t[0] for a, b in itertools.pairwise(poses)):
            return None
        heading = [np.full(len(p), np.nan) if p.course else p.yaw for p in poses]
        columns = (np.concatenate([getattr(p, name) for p in poses]) for name in ("t", "x", "y"))
        motion = pose_motion(*columns, np.concatenate(heading))  # type: ignore[call-arg]
        inputs = [series for run in runs if (series := inputs_of(run, name)) is not None]
        fits = agreements(inputs, motion, _OFFSETS, whole.unknown_after)
        best, none = int(np.argmax(fits)), float(fits[len(_OFFSETS) // 2])
        offset, (low, high) = float(_OFFSETS[best]), _APART[name]
        if low <= offset <= high or fits[best] < _FIT or fits[best] < none + _BETTER:
            return None
        late = ", or the drive answers so late" if name == "command" and offset < 0.0 else ""
        way = "earlier" if offset < 0.0 else "later"
        return self.found(
            f"poses and {WORDS[name].name} agree best ({fits[best]:.2f}, now {none:.2f}) with poses "
            f"{abs(offset):.1f} s {way}: their clocks are apart, or one waits in a queue{late}",
            "Give --pose-clock-offset auto, and stamp poses when they are measured.",
            evidence=offset,
            spoils=name == "command" and offset > 0.0,  # no drive answers before it is commanded
        )


def told_by(whole: WholeLog) -> str:
    """Return which input tells of clocks: wheels, which no drive delays, where there are any."""
    return "wheel" if any(run.wheels for run in whole.log.runs) else "command"


def inputs_of(run: Run, name: str) -> Inputs | None:
    """Return commands or wheels of a run; None where there are fewer than two."""
    inputs = run.commands if name == "command" else run.wheels
    return inputs if inputs is not None and len(inputs) > 1 else None


def _frozen(run: Run, whole: WholeLog) -> list[tuple[float, str]]:
    """Return seconds and place of each stretch of a run."""
    inputs, poses = inputs_of(run, whole.input_name), run.poses.as_measured
    if inputs is None or len(poses) < 3:
        return []
    first, last = _stretches(poses)
    usual = float(np.median(np.diff(poses.t)))
    moved = np.hypot(inputs.v, inputs.vy) + _ARM * np.abs(inputs.omega)
    driven = HeldSum.of(inputs, moved, whole.unknown_after).between(first, last)
    long = (last - first > max(_LONG, _STEPS * usual)) & (driven > _DRIVEN)
    both = zip((last - first)[long].tolist(), first[long].tolist(), strict=True)
    return [(seconds, run.place(start)) for seconds, start in both]


def _stretches(poses: Poses) -> tuple[Floats, Floats]:
    """Return from when until when each pose stood [s], until the first that differs."""
    rows = np.column_stack((poses.x, poses.y, poses.yaw, poses.frame))
    new = np.flatnonzero(np.concatenate(([True], (np.diff(rows, axis=0) != 0.0).any(axis=1))))
    return poses.t[new], poses.t[np.append(new[1:], len(poses) - 1)]

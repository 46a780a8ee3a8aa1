# SPDX-License-Identifier: Apache-2.0
"""Keeps the last two minutes of what a live node hears, to look at them as at a log."""

from __future__ import annotations

import math
from collections import Counter, deque
from dataclasses import replace

import numpy as np

from slipwise.calibration.mounts import Mount, MountWatch
from slipwise.live.samples import Command, Pose, Reading, Stamped, Wheels
from slipwise.logs.findings.checks import OF_STREAM, findings_of_others, looked_at
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.gyro import COLUMN
from slipwise.logs.log import Inputs, LeftOut, Log, Poses, Run, empty_poses
from slipwise.logs.navsat import course_of_path
from slipwise.logs.stamps import BACKWARD, GOES_BACK

KEPT = 120.0  # s
LOOKED_EVERY = 60.0  # s
MOST = 20_000  # samples of a kind

_Row = tuple[float, ...]
_NAMES: dict[type | str, str] = {Command: "commands", Wheels: "wheels", Pose: "poses"}


class RecentLog:
    """Commands, wheels, yaw rates and poses of each source as they came.

    Args:
        input_name: "command" or "wheel", the input that is learned from.
        unknown_after: an input is unknown once it is older than this [s].
        place: where the first source of poses sits in base_link (x, y [m], yaw [rad]).
    """

    def __init__(
        self, input_name: str, unknown_after: float, place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> None:
        self._input, self._unknown_after = input_name, unknown_after
        self._rows: dict[type | str, deque[_Row]] = {}  # by the kind; of further sources, by the name
        self._first = ""  # name of the first source
        self._positions: set[type | str] = set()  # of the sources of poses, those without headings
        self._back: deque[tuple[float, str]] = deque(maxlen=MOST)  # stamps of what went back, with its name
        self._newest, self._looked_at = -math.inf, math.nan
        self._found: dict[str, Finding] = {}
        self._placing, self._placed_at = MountWatch(place), math.nan
        self._mounts: tuple[Mount, ...] = ()

    def take(self, sample: Stamped, *, further: bool = False) -> None:
        """Take a sample; one that is not later than those of its kind says nothing.

        Args:
            sample: a command, wheels, a yaw rate or a pose; other samples are not kept.
            further: a pose of a source beside the first, by whose name it is kept.
        """
        kind: type | str = type(sample)
        if isinstance(sample, Pose):
            beside = (sample.roll, sample.pitch, sample.z)
            position = math.isnan(sample.yaw)
            yaw = 0.0 if position else sample.yaw
            row: _Row = (sample.t, sample.x, sample.y, yaw, *map(_or_nan, beside))
            if further:
                kind = sample.source
            else:
                self._first = sample.source
            (self._positions.add if position else self._positions.discard)(kind)
        elif isinstance(sample, Command) and sample.ended:  # nobody sent it
            return
        elif isinstance(sample, Command | Wheels):
            row = (sample.t, sample.v, sample.vy, sample.omega)
        elif isinstance(sample, Reading) and sample.column == COLUMN:
            row = (sample.t, sample.value)
        else:
            return
        rows = self._rows.setdefault(kind, deque(maxlen=MOST))
        if kind in _NAMES and rows and row[0] < rows[-1][0]:
            self._back.append((row[0], _NAMES[kind]))
        if not all(map(math.isfinite, row[:4])) or (rows and row[0] <= rows[-1][0]):
            return
        rows.append(row)
        self._newest = max(self._newest, row[0])
        while rows[0][0] < self._newest - KEPT:
            rows.popleft()

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._rows.clear()
        self._back.clear()
        self._placing.restart()
        self._newest, self._looked_at, self._placed_at = -math.inf, math.nan, math.nan

    def found(self) -> tuple[Finding, ...]:
        """Return what was found so far; the last minutes are looked at now and then."""
        if math.isnan(self._looked_at):
            self._looked_at = self._newest
        if self._newest >= self._looked_at + LOOKED_EVERY:
            self._looked_at = self._newest
            whole = WholeLog(self._log(), self._input, self._unknown_after)
            for each in looked_at(whole, OF_STREAM):
                self._found.setdefault(each.kind, each)
            for each in findings_of_others(whole.log, self._input, self._unknown_after, ()):
                self._found.setdefault(f"{each.kind} of others", each)
        return tuple(self._found.values())

    def mounts(self, *, last: bool = False) -> tuple[Mount, ...]:
        """Return where further sources sit; it is looked at again now and then, and at last."""
        if math.isnan(self._placed_at):
            self._placed_at = self._newest
        several = any(isinstance(kind, str) for kind in self._rows)
        if several and (last or self._newest >= self._placed_at + LOOKED_EVERY):
            self._placed_at = self._newest
            (run,) = self._log().runs
            self._placing.take(run)
            self._mounts = self._placing.mounts()
        return self._mounts

    def _log(self) -> Log:
        commands, wheels = (self._inputs(kind) for kind in (Command, Wheels))
        inputs = commands if wheels is None else wheels
        others = {name: self._poses(name, inputs) for name in self._rows if isinstance(name, str)}
        gyro = np.array(self._rows.get(Reading, ())).reshape(-1, 2).T
        extra = dict(zip(("t", COLUMN), gyro, strict=True)) if gyro.size else {}
        run = Run(
            "live", commands, wheels, self._poses(Pose, inputs), extra, others=others, source=self._first
        )
        while self._back and self._back[0][0] < self._newest - KEPT:
            self._back.popleft()
        back = Counter(name for _, name in self._back)
        left_out = tuple(
            LeftOut(f"{name} {GOES_BACK}", count, "live", BACKWARD) for name, count in back.items()
        )
        return Log(runs=(run,), left_out=left_out)

    def _poses(self, kind: type | str, inputs: Inputs | None) -> Poses:
        rows = self._rows.get(kind)
        if not rows:
            return empty_poses()
        t, x, y, yaw, roll, pitch, z = np.ascontiguousarray(np.array(rows).T)
        poses = Poses(t, x, y, yaw, np.zeros(len(t), np.int64), z=z, roll=roll, pitch=pitch)
        if kind not in self._positions:
            return poses
        return replace(poses, yaw=course_of_path(t, x, y, inputs), course=True)

    def _inputs(self, kind: type) -> Inputs | None:
        rows = self._rows.get(kind)
        return Inputs(*np.ascontiguousarray(np.array(rows).T)) if rows else None


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value

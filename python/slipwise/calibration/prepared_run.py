# SPDX-License-Identifier: Apache-2.0
"""A log made ready for learning: the inputs of each run, and its windows in the order they are learned."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.same_log import refuse_same_log
from slipwise.errors import LogError
from slipwise.logs.gyro import gyro_alone, gyro_rows
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Inputs, LeftOut, Log, Run, Source
from slipwise.models.inputs import MANY, input_name_of
from slipwise.segments import WindowRules, cut_windows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_MEASURED = 2  # poses or yaw rates of a run that is learned from
OVERLAP = 1.0  # s; runs of one clock overlap by less, where files were split while messages were on the way


@dataclass(frozen=True, eq=False)
class PreparedRun:
    """A run with the inputs to predict from."""

    index: int  # of the run in the log
    run: Run
    inputs: Inputs
    wheels: Inputs | None  # measured at the start of a prediction from commands
    input_name: str = "command"  # or "wheel": of `inputs`

    @property
    def begin(self) -> float:
        """Stamp of the first pose; without poses, of the first input [s]."""
        return float(self.run.poses.t[0]) if len(self.run.poses) else self.run.span[0]

    @property
    def end(self) -> float:
        """Stamp of the last pose; without poses, of the last input [s]."""
        return float(self.run.poses.t[-1]) if len(self.run.poses) else self.run.span[1]


@dataclass(frozen=True, eq=False)
class WindowSet:
    """The windows of all runs, in order, [N] each."""

    length: float  # s, as asked for
    drive: tuple[PreparedRun, ...]
    position: Ints  # of the window's run in `drive`
    start: Floats  # s
    end: Floats  # s
    measured: Floats  # [N, 3]
    segments: tuple[_core.Segment, ...]
    histories: tuple[_core.InputHistory, ...]  # the inputs that act in each, or before it
    unknown_after: float  # s; an input is unknown once it is older than this
    left_out: tuple[LeftOut, ...]

    def __len__(self) -> int:
        return len(self.start)

    def input_history(self, i: int, limits: _core.CommandLimits | None = None) -> _core.InputHistory:
        """Return the inputs of window i, behind the limits of the actuator where there are some."""
        history = self.histories[i]
        return history if limits is None else _core.limited_inputs(history, limits, _core.RAMP_PIECE)

    def distances(self) -> Floats:
        """Return how far the robot was driven in each window, by its inputs, [N] m."""
        distances = np.empty(len(self))
        for k, run in enumerate(self.drive):
            at = self.position == k
            driven = HeldSum.of(run.inputs, np.hypot(run.inputs.v, run.inputs.vy), self.unknown_after)
            distances[at] = driven.between(self.start[at], self.end[at])
        return distances

    def count_until(self, position: Ints, time: Floats) -> Ints:
        """Return how many windows had ended by `time` of run `position`, [M] each.

        Earlier runs on another clock count whole. Runs whose stamps follow each other are on one clock.
        """
        clocks = self._clocks[position]
        counts = np.empty(len(time), dtype=np.int64)
        for clock in np.unique(clocks).tolist():
            first, last = np.searchsorted(self._clock_of_each, (clock, clock + 1)).tolist()
            at = clocks == clock
            counts[at] = first + np.searchsorted(
                self.end[first:last], time[at] + _core.SAME_STAMP, side="right"
            )
        return counts

    def passed(self, pace: WindowSet) -> Ints:
        """Return how many windows had ended when each window of `pace` did, [len(pace)]."""
        return self.count_until(pace.position, pace.end)

    @cached_property
    def _clock_of_each(self) -> Ints:
        """Number of each window's clock, [N]."""
        return self._clocks[self.position]

    @cached_property
    def _clocks(self) -> Ints:
        """Number of each run's clock, [runs]."""
        restarts = [
            earlier.end > later.begin + _core.SAME_STAMP for earlier, later in itertools.pairwise(self.drive)
        ]
        return np.cumsum([0, *restarts], dtype=np.int64)


def prepare_run(log: Log, input_name: str) -> tuple[PreparedRun, ...]:
    """Choose the inputs of every run.

    Raises:
        LogError: no run has such inputs, no run has poses, or a drive is there twice.
        SettingsError: there is no such input.
    """
    input_name = input_name_of(input_name, where="--input")
    refuse_same_log(log)
    drive = []
    alone = gyro_alone(log.runs)
    for index, run in enumerate(log.runs):
        inputs = run.commands if input_name == "command" else run.wheels
        if inputs is None or _lacking(run, input_name, alone=alone):
            continue
        wheels = run.wheels if input_name == "command" else None
        drive.append(PreparedRun(index, run, inputs, wheels, input_name))
    if not drive:
        where = ", ".join(source.path for source in log.sources[:3])
        raise LogError(_nothing_to_use(log, input_name), where=where, advice=_advice(log, input_name))
    return tuple(_in_time(drive))


def unused_runs(log: Log, input_name: str) -> tuple[LeftOut, ...]:
    """Count the runs of which `prepare_run` can make nothing, beside others of which it can."""
    lacking = _all_lacking(log, input_name)
    return tuple(
        LeftOut(
            f"runs without {what}", lacking.count(what), _place(log.runs[lacking.index(what)]), "unused-run"
        )
        for what in dict.fromkeys(filter(None, lacking))
    )


def used_sources(log: Log, input_name: str) -> tuple[Source, ...]:
    """Return the files that `prepare_run` uses something of."""
    lacking = _all_lacking(log, input_name)
    used = {file for run, lack in zip(log.runs, lacking, strict=True) if not lack for file in run.files}
    unused = {file for run in log.runs for file in run.files} - used
    return tuple(source for source in log.sources if source.path not in unused)


def _all_lacking(log: Log, input_name: str) -> list[str]:
    alone = gyro_alone(log.runs)
    return [_lacking(run, input_name, alone=alone) for run in log.runs]


def _lacking(run: Run, input_name: str, *, alone: bool) -> str:
    """Return what a run lacks to be learned from; empty where it has all."""
    inputs = run.commands if input_name == "command" else run.wheels
    if inputs is None or len(inputs) == 0:
        return MANY[input_name]
    if (len(gyro_rows(run)) if alone else len(run.poses)) < LEAST_MEASURED:
        others = [name for name, poses in run.others.items() if len(poses)]
        of = f" of {run.source}, beside which {' and '.join(others)} are learned" if others else ""
        return "yaw rates" if alone else f"poses{of}"
    return ""


def _place(run: Run) -> str:
    return f"run {run.name}" + (f" of {', '.join(run.files)}" if run.files else "")


def _in_time(drive: list[PreparedRun]) -> list[PreparedRun]:
    """Order runs by their start where they are on one clock: files may come in any order.

    Runs that overlap count their time from a start of their own each, and stay in the order given.
    """
    ordered = sorted(drive, key=lambda run: run.begin)
    overlap = any(later.begin < earlier.end - OVERLAP for earlier, later in itertools.pairwise(ordered))
    return drive if overlap else ordered


def choose_input(log: Log, asked: str | None = None) -> str:
    """Return the input that is asked for; else "command" where the log has commands, otherwise "wheel".

    Raises:
        SettingsError: there is no such input.
    """
    if asked is not None:
        return input_name_of(asked, where="--input")
    return next(iter(input_names(log)), "wheel")


def collect_windows(
    drive: tuple[PreparedRun, ...],
    length: float,
    rules: WindowRules,
    held: _core.CarCurves | None = None,
) -> WindowSet:
    """Cut all runs into windows of `length` [s]; `held` curves say what throttle and steering do."""
    settings = rules.stream_settings(length, from_commands=drive[0].input_name == "command")
    cut = cut_windows([run.run for run in drive], settings, held)
    return WindowSet(
        length=length,
        drive=drive,
        position=cut.run,
        start=cut.start,
        end=cut.end,
        measured=cut.measured,
        segments=cut.segments,
        histories=cut.histories,
        unknown_after=rules.unknown_after,
        left_out=cut.left_out,
    )


def has_wheels(drive: tuple[PreparedRun, ...]) -> bool:
    """Whether every run has wheel speeds beside its commands."""
    return all(run.wheels is not None and len(run.wheels) > 1 for run in drive)


def _nothing_to_use(log: Log, input_name: str) -> str:
    if all(len(run.poses) < 2 for run in log.runs):
        if any(len(run.poses) == 1 for run in log.runs):
            return "the robot never moves in this log: all its poses are the same"
        lost = "; ".join(f"{item.count} x {item.reason}" for item in _lost_poses(log))
        return f"no pose of the log can be used: {lost}" if lost else "the log has no poses"
    if not input_names(log):
        return "the log has no commands and no wheel speeds"
    if input_name in input_names(log):
        return f"no run of the log has both {MANY[input_name]} and poses"
    return f"the log has no {input_name} input" if input_name == "wheel" else "the log has no commands"


def _lost_poses(log: Log) -> tuple[LeftOut, ...]:
    """Return the poses that were left out."""
    return tuple(i for i in log.left_out if i.reason.startswith("poses") or i.kind == "no-fix")


def frames_apart(log: Log) -> str:
    """Say that poses change their frame so often that hardly two can be compared; empty where they do not."""
    poses = sum(len(run.poses) for run in log.runs)
    frames = sum(len(set(run.poses.frame.tolist())) for run in log.runs)
    if frames < 2 or 2 * frames < poses:
        return ""
    return f"{poses} poses have {frames} frames, and only poses of one frame are compared: give all the same"


def _advice(log: Log, input_name: str) -> str:
    """Say what to do; another input is proposed only where the log has it."""
    if all(len(run.poses) < 2 for run in log.runs):
        if _lost_poses(log):
            return "look at what writes them, or name another pose topic with --pose-topic"
        return "record where the robot went (RTK, lidar, mocap), or name the pose topic with --pose-topic"
    if input_name in input_names(log):
        return f"record poses in the runs that have {MANY[input_name]}"
    if input_name in log.advice:
        return log.advice[input_name]
    name = f"name the topic with --{input_name}-topic, or the columns (see `slipwise inspect`)"
    others = [other for other in input_names(log) if other != input_name]
    if others:
        return f"use --input {others[0]}, or {name}"
    return "record commands or wheel speeds; name their topic with --command-topic or --wheel-topic"


def input_names(log: Log) -> tuple[str, ...]:
    """Return the kinds of input that the log has."""
    found = {"command": [run.commands for run in log.runs], "wheel": [run.wheels for run in log.runs]}
    return tuple(
        name for name, series in found.items() if any(inputs is not None and len(inputs) for inputs in series)
    )

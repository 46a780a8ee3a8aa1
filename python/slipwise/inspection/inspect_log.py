# SPDX-License-Identifier: Apache-2.0
"""Puts together what is in a log: streams, faults, timing, coverage and what can be learned."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration import Settings
from slipwise.calibration.learned import Learned
from slipwise.calibration.prepared_run import choose_input
from slipwise.calibration.settings import AVERAGE
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import LogError
from slipwise.inspection.coverage_map import coverage_map
from slipwise.inspection.learnability import Learnability, LearnableParameter, learnability_of
from slipwise.logs import Log, LogOptions, Survey, open_log, survey_log
from slipwise.logs.findings.diagnose import each_once
from slipwise.logs.findings.finding import Finding, RefusedLogError
from slipwise.models.body_lag import is_hidden_lag
from slipwise.segments import WindowRules

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Inspection:
    """What is in a log."""

    log: Log
    streams: tuple[Stream, ...]
    learned: tuple[Learnability, ...]  # one for each kind of input, commands first
    timing: tuple[Timing, ...]
    maps: dict[str, tuple[str, ...]]  # lines of the coverage map, by kind of input
    found: tuple[Finding, ...] = ()  # all that is wrong in it
    surveys: tuple[Survey, ...] = ()  # of each file: its topics or columns, and what they are used as
    problem: str = ""  # why the files make no log as they are; then the rest is empty
    kept: Learned | None = None  # what a model of the log is made of, where it was asked for


def inspect_files(
    paths: Sequence[str | Path],
    options: LogOptions,
    settings: Settings | None = None,
    *,
    progress: Callable[[str, float], None] | None = None,
    keep: bool = False,
) -> Inspection:
    """Look at files that should make a log; what is merely unclear or missing in them is no error.

    Args:
        paths: as for `open_log`.
        options: as for `open_log`.
        settings: as for `inspect_log`.
        progress: called with what is done now, and how much of all is done.
        keep: as for `inspect_log`.

    Raises:
        LogError: a file is missing, damaged or of an unknown kind.
    """
    surveys = tuple(survey_log(path, options) for path in paths)
    try:
        log = open_log(*paths, options=options)
    except LogError as unusable:
        found = (unusable.found,) if isinstance(unusable, RefusedLogError) else ()
        return Inspection(Log(runs=()), (), (), (), {}, found, surveys, str(unusable))
    if progress is not None:
        progress("learning", 0.5)
    return replace(inspect_log(log, settings, keep=keep), surveys=surveys)


def inspect_log(log: Log, settings: Settings | None = None, *, keep: bool = False) -> Inspection:
    """Look at a log; one without anything to learn is looked at as well.

    Args:
        log: what `open_log` returned.
        settings: rules of windows, and the basis to learn; `auto` by default.
        keep: keep what was learned from the input that `calibrate` chooses, where it learns the same, so that
            `next_drive` need not learn it again.
    """
    settings = settings or Settings()
    kept: dict[str, Learned] = {}
    chosen = choose_input(log) if keep and _as_calibrate(log, settings) else None
    inputs = {
        "command": [run.commands for run in log.runs if run.commands is not None],
        "wheel": [run.wheels for run in log.runs if run.wheels is not None],
    }
    present = [name for name, series in inputs.items() if any(len(part) for part in series)]
    learned = tuple(
        learnability_of(log, name, settings, kept if name == chosen else None)
        for name in present or ["command"]
    )
    return Inspection(
        log=log,
        streams=streams_of(log, settings.rules()),
        learned=learned,
        timing=tuple(timing for item in learned for timing in timing_of(item)),
        maps={
            name: coverage_map(inputs[name], unknown_after=settings.segment.unknown_after) for name in present
        },
        found=each_once((*log.found, *(found for item in learned for found in item.contradictions))),
        kept=kept.get(chosen or ""),
    )


def _as_calibrate(log: Log, settings: Settings) -> bool:
    """Whether `calibrate` learns this log with these settings as they are."""
    return settings.estimator == AVERAGE and for_the_ground_of(log, settings) == settings


@dataclass(frozen=True)
class Stream:
    """One stream over all runs of a log; what is not known is NaN."""

    name: str  # "commands", "wheels" or "poses"
    runs: int  # that have it
    samples: int
    seconds: float  # s, from first to last sample, added up over the runs
    rate: float  # [Hz] one over the median interval
    gaps: int  # intervals after which inputs are unknown or a pose is late
    longest_gap: float  # s, the longest interval
    frames: int  # that poses are comparable in; 0 for inputs


def streams_of(log: Log, rules: WindowRules) -> tuple[Stream, ...]:
    """Return the streams that a log has, commands first."""
    found = []
    for name in ("commands", "wheels", "poses"):
        stamps: list[Floats] = []
        frames = 0
        for run in log.runs:
            series = {"commands": run.commands, "wheels": run.wheels, "poses": run.poses}[name]
            if series is not None and len(series):
                stamps.append(series.t)
                frames += len(np.unique(run.poses.frame)) if name == "poses" else 0
        if stamps:
            found.append(_stream(name, stamps, frames, rules))
    return tuple(found)


def _stream(name: str, stamps: Sequence[Floats], frames: int, rules: WindowRules) -> Stream:
    intervals = np.concatenate([np.diff(t) for t in stamps])
    usual = float(np.median(intervals)) if len(intervals) else float("nan")
    allowed = rules.late_factor * usual if name == "poses" else rules.unknown_after
    return Stream(
        name=name,
        runs=len(stamps),
        samples=sum(len(t) for t in stamps),
        seconds=float(sum(t[-1] - t[0] for t in stamps)),
        rate=1.0 / usual if usual > 0.0 else float("nan"),
        gaps=int(np.count_nonzero(intervals > allowed)) if len(intervals) else 0,
        longest_gap=float(intervals.max()) if len(intervals) else float("nan"),
        frames=frames,
    )


@dataclass(frozen=True)
class Timing:
    """A time between inputs and poses."""

    input: str  # "command" or "wheel"
    name: str
    seconds: float  # s
    std: float  # s
    identifiable: bool
    meaning: str


_OF_WHEELS = {
    "clock_offset": "poses come this much later than wheel speeds, by their stamps or as the body does",
    "log_time_constant_v": "the body's speed follows that of its wheels with this time constant",
    "log_time_constant_omega": "the body's yaw rate follows that of its wheels with this time constant",
}
_OF_COMMANDS = {
    "delay_v": "from a speed command to the speed, with no lag",
    "delay_omega": "from a yaw rate command to the yaw rate, with no lag",
    "log_delay_v": "from a speed command to the first effect",
    "log_delay_omega": "from a yaw rate command to the first effect",
    "log_time_constant_v": "then the speed follows with this time constant",
    "log_time_constant_omega": "then the yaw rate follows with this time constant",
    "log_slow_time_constant_v": "a part of the speed follows with this time constant",
    "log_slow_time_constant_omega": "a part of the yaw rate follows with this time constant",
}


def timing_of(learned: Learnability) -> tuple[Timing, ...]:
    """Return the times that were learned, in s; none where nothing could be learned.

    Where commands were learned by way of the wheel speeds, the clock offset is that of the wheel speeds, and
    said there. Lags of a body that hardly lags are left out.
    """
    wheels = learned.input == "wheel"
    apart = wheels or learned.parameter("clock_offset") is not None
    meanings = _OF_WHEELS if wheels else _OF_COMMANDS
    found = [(p, meanings[p.name]) for p in map(learned.parameter, meanings) if p is not None]
    included = "" if apart else ", clock offset included"
    return tuple(
        _timing(learned.input, p, meaning + (included if "delay" in p.name else ""))
        for p, meaning in found
        if not (wheels and is_hidden_lag(p.name, p.value, p.std))
    )


def _timing(input_name: str, parameter: LearnableParameter, meaning: str) -> Timing:
    name = parameter.name.removeprefix("log_")
    seconds, std = parameter.value, parameter.std
    if name != parameter.name:
        seconds, std = math.exp(seconds), math.exp(seconds) * std
    return Timing(input_name, name, seconds, std, parameter.identifiable, meaning)

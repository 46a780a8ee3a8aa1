# SPDX-License-Identifier: Apache-2.0
"""Puts together what is in a log: streams, faults, timing, coverage and what can be learned."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from slipwise.calibration import Settings
from slipwise.calibration.learned import Learned
from slipwise.calibration.prepared_run import choose_input
from slipwise.calibration.settings import AVERAGE
from slipwise.calibration.sloping_ground import for_the_ground_of
from slipwise.errors import LogError
from slipwise.inspection.coverage_map import coverage_map
from slipwise.inspection.learnability import Learnability, learnability_of
from slipwise.inspection.streams import Stream, streams_of
from slipwise.inspection.timing import Timing, timing_of
from slipwise.logs import Log, LogOptions, Survey, open_log, survey_log
from slipwise.logs.findings.diagnose import each_once
from slipwise.logs.findings.finding import Finding, RefusedLogError


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

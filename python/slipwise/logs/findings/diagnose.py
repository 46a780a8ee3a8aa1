# SPDX-License-Identifier: Apache-2.0
"""Everything that is wrong in a log: what its reader found, and what poses and either input show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slipwise.addresses import shown
from slipwise.logs.findings.checks import EVERY, findings_of_each
from slipwise.logs.findings.finding import Finding, RefusedLogError
from slipwise.logs.findings.seen import AT_CENTRE, Place
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Log
from slipwise.logs.open_log import open_log
from slipwise.logs.options import LogOptions

_OF_AN_INPUT = ("unlikely-speed",)  # said of commands and of wheels; of other kinds one tells the other
_HIDDEN_BY = {check.kind: check.hidden_by for check in EVERY}


@dataclass(frozen=True)
class Diagnosis:
    """What was found in one log."""

    path: str
    found: tuple[Finding, ...]
    log: Log | None  # None where it is refused for what was found


def diagnose(path: str | Path, options: LogOptions, *, sensor: Place = AT_CENTRE) -> Diagnosis:
    """Read a log and say what is wrong with it.

    Args:
        path: as for `open_log`.
        options: as for `open_log`.
        sensor: where the pose sensor is known to sit on the robot: x, y [m], yaw [rad].

    Raises:
        LogError: the file is missing, damaged or of an unknown kind, or makes no log.
    """
    try:
        log = open_log(path, options=options)
    except RefusedLogError as refused:
        return Diagnosis(shown(Path(path)), (refused.found,), None)
    return Diagnosis(shown(Path(path)), diagnose_log(log, options.unknown_after, sensor=sensor), log)


def diagnose_log(
    log: Log, unknown_after: float = UNKNOWN_AFTER, *, sensor: Place = AT_CENTRE
) -> tuple[Finding, ...]:
    """Return all that is wrong in a log, each kind of thing once.

    Args:
        log: what `open_log` returned.
        unknown_after: an input is unknown once it is older than this [s].
        sensor: where the pose sensor is known to sit on the robot: x, y [m], yaw [rad].
    """
    there = {"command": any(run.commands for run in log.runs), "wheel": any(run.wheels for run in log.runs)}
    names = [name for name, known in there.items() if known]
    return each_once((*log.found, *findings_of_each(log, names, unknown_after, sensor)))


def each_once(found: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return one finding of each kind that no other hides; of kinds of one input alone, each sentence."""
    every = tuple(found)
    kinds = {each.kind for each in every}
    first: dict[tuple[str, str], Finding] = {}
    for each in every:
        if not kinds.intersection(_HIDDEN_BY[each.kind]) - {each.kind}:
            first.setdefault((each.kind, each.sentence if each.kind in _OF_AN_INPUT else ""), each)
    return tuple(first.values())

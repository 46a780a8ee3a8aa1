# SPDX-License-Identifier: Apache-2.0
"""A robot's watchdog ends commands that are not repeated: so they end in a log."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.logs.log import Inputs, Log

REPEAT = 0.2  # s between the zeros that stand for an ended command,
_LONGEST = 600.0  # s of them after each command


def end_stamps(given: float, seconds: float, until: float) -> list[float]:
    """Return the stamps [s] before `until` at which zeros stand for a command that was `given` and ended."""
    first = given + seconds
    count = int(np.ceil((min(until, given + _LONGEST) - first) / REPEAT))
    return [first + REPEAT * k for k in range(max(count, 0)) if first + REPEAT * k < until]


def with_ended_commands(log: Log, seconds: float | None) -> Log:
    """Return the log with commands that end `seconds` after each that is not repeated, which is noted."""
    if seconds is None:
        return log
    runs, count = [], 0
    for run in log.runs:
        if run.commands is not None:
            commands, ended = _ended(run.commands, seconds, run.span[1])
            run, count = replace(run, commands=commands), count + ended
        runs.append(run)
    note = f"commands end {seconds:g} s after each, as given: {count} were not repeated in that time"
    return replace(log, runs=tuple(runs), notes=(*log.notes, note))


def _ended(commands: Inputs, seconds: float, last: float) -> tuple[Inputs, int]:
    following = np.append(commands.t[1:], max(last, float(commands.t[-1])))
    zeros = [
        stamps
        for given, after in zip(commands.t.tolist(), following.tolist(), strict=True)
        if (stamps := end_stamps(given, seconds, after))
    ]
    added = np.array([stamp for stamps in zeros for stamp in stamps])
    t = np.concatenate((commands.t, added))
    order = np.argsort(t, kind="stable")
    ended = np.concatenate((commands.ends, np.ones(len(added), bool)))[order]
    none = np.zeros(len(added))
    v, vy, omega = (np.concatenate((c, none))[order] for c in (commands.v, commands.vy, commands.omega))
    return replace(commands, t=t[order], v=v, vy=vy, omega=omega, ended=ended), len(zeros)

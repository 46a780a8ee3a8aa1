# SPDX-License-Identifier: Apache-2.0
"""A robot's watchdog ends commands that are not repeated: so they end in a log."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, Log

REPEAT = 0.2  # s between the zeros that stand for an ended command,
_LONGEST = 600.0  # s of them after each command
_AGAIN = 0.8  # of the time for which an input is known, after which one that is held is said again


def end_stamps(given: float, seconds: float, until: float) -> list[float]:
    """Return the stamps [s] before `until` at which zeros stand for a command that was `given` and ended."""
    first = given + seconds
    count = int(np.ceil((min(until, given + _LONGEST) - first) / REPEAT))
    return [at for k in range(max(count, 0)) if (at := first + REPEAT * k) < until - _core.SAME_STAMP]


def held_stamps(given: float, seconds: float, until: float, unknown_after: float) -> list[float]:
    """Return the stamps [s] before `until` at which a command that was `given` is said again.

    A watchdog that waits for longer than inputs are known holds it so long, and so it stays known.
    """
    if seconds <= unknown_after:
        return []
    last, step = min(until, given + min(seconds, _LONGEST)), _AGAIN * unknown_after
    count = int(np.ceil((last - given) / step))
    return [at for k in range(1, max(count, 1)) if (at := given + step * k) < last - _core.SAME_STAMP]


def ends_after(commands: Inputs) -> float | None:
    """Return how long after a command that is not repeated a watchdog is said to end it [s], if one is."""
    none = (commands.v == 0.0) & (commands.vy == 0.0) & (commands.omega == 0.0)
    ends, sent = commands.t[commands.ends & none], commands.select(~commands.ends & ~none).t
    if not len(ends):
        return None
    newest = np.searchsorted(sent, ends) - 1
    first = np.flatnonzero(np.diff(newest, prepend=-1) > 0)
    return float(np.median(ends[first] - sent[newest[first]])) if len(first) else None


def with_ended_commands(log: Log, seconds: float | None, unknown_after: float = UNKNOWN_AFTER) -> Log:
    """Return the log with commands that end `seconds` after each that is not repeated, which is noted.

    Until then a command is held, and known, also where an input is unknown `unknown_after` seconds later.
    """
    if seconds is None:
        return log
    runs, count = [], 0
    for run in log.runs:
        if run.commands is not None:
            commands, ended = _ended(run.commands, (seconds, unknown_after), run.span[1])
            run, count = replace(run, commands=commands), count + ended
        runs.append(run)
    note = f"commands end {seconds:g} s after each, as given: {count} were not repeated in that time"
    return replace(log, runs=tuple(runs), notes=(*log.notes, note))


def _ended(commands: Inputs, times: tuple[float, float], last: float) -> tuple[Inputs, int]:
    seconds, unknown_after = times
    following = np.append(commands.t[1:], max(last, float(commands.t[-1]))).tolist()
    held: list[tuple[float, int]] = []
    zeros: list[float] = []
    ends, said = 0, commands.t.tolist()
    for k, (given, after) in enumerate(zip(said, following, strict=True)):
        held += [(at, k) for at in held_stamps(given, seconds, after, unknown_after)]
        stamps = end_stamps(given, seconds, after)
        zeros += stamps
        ends += bool(stamps)
    t = np.concatenate((commands.t, np.array([at for at, _ in held]), np.array(zeros)))
    order = np.argsort(t, kind="stable")
    again = np.array([k for _, k in held], dtype=np.int64)
    unsent = np.ones(len(again) + len(zeros), bool)
    ended = np.concatenate((commands.ends, unsent))[order]
    none = np.zeros(len(zeros))
    columns = (commands.v, commands.vy, commands.omega)
    v, vy, omega = (np.concatenate((c, c[again], none))[order] for c in columns)
    return replace(commands, t=t[order], v=v, vy=vy, omega=omega, ended=ended), ends

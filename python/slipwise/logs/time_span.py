# SPDX-License-Identifier: Apache-2.0
"""Cuts a log to a span of seconds from its start."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.log import Floats, Inputs, Log, Poses, Run


def cut_to_span(log: Log, start: float | None, end: float | None) -> Log:
    """Return what lies between `start` and `end` [s], counted from the first stamp of the log.

    The input that is held at the start stays. Where runs begin their clocks again, each is cut so.

    Raises:
        LogError: nothing is left.
    """
    stamps = [t for run in log.runs for t in _stamps(run) if len(t)]
    if (start is None and end is None) or not stamps:
        return log
    first, last = min(float(t[0]) for t in stamps), max(float(t[-1]) for t in stamps)
    low, high = first + (start or 0.0), first + (math.inf if end is None else end)
    runs = tuple(run for run in (_cut_run(run, low, high) for run in log.runs) if len(run.poses))
    until = "its end" if end is None else f"{end:g} s"
    span = f"{start or 0.0:g} s to {until}"
    if not runs:
        where = log.sources[0].path if log.sources else ""
        given = " ".join(f"--{n} {v:g}" for n, v in (("start", start), ("end", end)) if v is not None)
        what = f"the log is {last - first:.0f} s long; {given} leaves no pose"
        raise LogError(what, where=where, advice="choose times within the log")
    return replace(log, runs=runs, notes=(*log.notes, f"only {span} of {last - first:.1f} s are used"))


def _stamps(run: Run) -> tuple[Floats, ...]:
    inputs = [series.t for series in (run.commands, run.wheels) if series is not None]
    return (run.poses.t, *inputs)


def _cut_run(run: Run, low: float, high: float) -> Run:
    def inside(poses: Poses) -> Poses:
        return poses.select((poses.t >= low) & (poses.t <= high))

    extra = {}
    if run.extra:
        t = np.asarray(run.extra["t"], dtype=np.float64)
        extra = {name: values[(t >= low) & (t <= high)] for name, values in run.extra.items()}
    forces = run.forces
    return replace(
        run,
        commands=_cut(run.commands, low, high),
        wheels=_cut(run.wheels, low, high),
        poses=inside(run.poses),
        extra=extra,
        others={name: inside(other) for name, other in run.others.items()},
        forces=None if forces is None else forces.select(_held_part(forces.t, low, high)),
    )


def _cut(inputs: Inputs | None, low: float, high: float) -> Inputs | None:
    cut = None if inputs is None else inputs.select(_held_part(inputs.t, low, high))
    return cut or None


def _held_part(t: Floats, low: float, high: float) -> slice:
    """Return which samples lie in a span, with the one before, which still holds."""
    held = max(int(np.searchsorted(t, low, side="right")) - 1, 0)
    return slice(held, int(np.searchsorted(t, high, side="right")))

# SPDX-License-Identifier: Apache-2.0
"""Cuts a log to a span of seconds from its start."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.log import Bools, Floats, Forces, Inputs, Log, Poses, Run


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
    poses = _kept_poses(run.poses, (run.poses.t >= low) & (run.poses.t <= high))
    extra = {}
    if run.extra:
        t = np.asarray(run.extra["t"], dtype=np.float64)
        extra = {name: values[(t >= low) & (t <= high)] for name, values in run.extra.items()}
    others = {
        name: _kept_poses(other, (other.t >= low) & (other.t <= high)) for name, other in run.others.items()
    }
    commands, wheels = _cut(run.commands, low, high), _cut(run.wheels, low, high)
    forces = run.forces
    if forces is not None:
        part = _held_part(forces.t, low, high)
        forces = Forces(forces.t[part], forces.x[part], forces.y[part])
    return replace(
        run, commands=commands, wheels=wheels, poses=poses, extra=extra, others=others, forces=forces
    )


def _cut(inputs: Inputs | None, low: float, high: float) -> Inputs | None:
    if inputs is None:
        return None
    part = _held_part(inputs.t, low, high)
    t, v, vy, omega = (column[part] for column in (inputs.t, inputs.v, inputs.vy, inputs.omega))
    car = None if inputs.car is None else inputs.car.between(part)
    cut = replace(inputs, t=t, v=v, vy=vy, omega=omega, car=car)
    return cut if len(cut) else None


def _held_part(t: Floats, low: float, high: float) -> slice:
    """Return which samples lie in a span, with the one before, which still holds."""
    held = max(int(np.searchsorted(t, low, side="right")) - 1, 0)
    return slice(held, int(np.searchsorted(t, high, side="right")))


def _kept_poses(poses: Poses, keep: Bools) -> Poses:
    others = {name: None if v is None else v[keep] for name, v in poses.optional().items()}
    t, x, y, yaw = (column[keep] for column in (poses.t, poses.x, poses.y, poses.yaw))
    return Poses(t=t, x=x, y=y, yaw=yaw, frame=poses.frame[keep], course=poses.course, **others)

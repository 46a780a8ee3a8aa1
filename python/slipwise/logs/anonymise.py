# SPDX-License-Identifier: Apache-2.0
"""Takes out of a log what says where, when and whose it was, and keeps what models are learned from."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.logs.log import Floats, Forces, Inputs, Log, Poses, Run
from slipwise.logs.vocabulary import PREFIXES, measured_by

_Series = TypeVar("_Series", Inputs, Forces)
LONGEST_GAP = 3600.0  # s between runs; a longer one would tell the hours of work
_DIGITS = 12  # hexadecimal, of a hashed name


def anonymised(log: Log, *, keep: Collection[str] = ()) -> Log:
    """Return the log without its place, its time and its names; motions and intervals stay what they were.

    Each frame of each run is turned and moved so that its first pose is the origin with a yaw of 0, and its
    first height 0. Stamps count from the log's start; gaps between runs end at `LONGEST_GAP`, and a run that
    is on another clock starts at 0. Names of runs become hashes over name and measurements, which cannot
    try out who does not have the log. Numbers of wheels and commands are carried along, other columns are
    not: they may hold coordinates, stamps or names.

    Args:
        log: what `open_log` returned.
        keep: further columns to carry along as they are.

    Raises:
        LogError: the log has no column that `keep` names.
    """
    there = {name for run in log.runs for name in run.extra} - {"t"}
    unknown = [name for name in keep if name not in there]
    if unknown:
        found = ", ".join(sorted(there)) or "none"
        raise LogError(
            f"no column {unknown[0]} to keep", where="--keep", advice=f"columns beside the tidy ones: {found}"
        )
    kept = {name for name in there if name in keep or _harmless(name)}
    shifts = _shifts([run.span for run in log.runs])
    runs = tuple(
        _run(run, index, shift, kept) for index, (run, shift) in enumerate(zip(log.runs, shifts, strict=True))
    )
    dropped = ", ".join(sorted(there - kept))
    notes = (f"not carried along: {dropped} (--keep NAME does)",) if dropped else ()
    return Log(runs=runs, sources=log.sources, left_out=log.left_out, notes=(*log.notes, *notes))


def _harmless(name: str) -> bool:
    """Whether a column beside the tidy ones holds speeds or angles of the vehicle alone."""
    return measured_by(name) in ("command", "wheel") or name.startswith((*PREFIXES, "cmd_", "odo_"))


def _shifts(spans: Iterable[tuple[float, float]]) -> list[float]:
    """What is taken from the stamps of each run [s]."""
    shifts: list[float] = []
    last, end = float("inf"), 0.0  # of the run before, as it was and as it is now
    for start, stop in spans:
        new = end + min(start - last, LONGEST_GAP) if start >= last else 0.0
        shifts.append(start - new)
        last, end = stop, stop - shifts[-1]
    return shifts


def _run(run: Run, index: int, shift: float, kept: Collection[str]) -> Run:
    return replace(
        run,
        name=_hashed(run, index),
        commands=_later(run.commands, shift),
        wheels=_later(run.wheels, shift),
        poses=_poses(run.poses, shift),
        extra=_extra(run.extra, shift, kept),
        others={name: _poses(poses, shift) for name, poses in run.others.items()},
        files=(),
        forces=_later(run.forces, shift),
    )


def _hashed(run: Run, index: int) -> str:
    """Return a name that the same log gives again, and that no list of likely names leads back from."""
    digest = hashlib.sha256(f"{index}\0{run.name}\0".encode())
    for values in (run.poses.t, run.poses.x, run.poses.y, run.poses.yaw):
        digest.update(np.ascontiguousarray(values).tobytes())
    return f"run-{digest.hexdigest()[:_DIGITS]}"


def _later(series: _Series | None, shift: float) -> _Series | None:
    return None if series is None else replace(series, t=series.t - shift)


def _poses(poses: Poses, shift: float) -> Poses:
    columns = {name: getattr(poses, name).copy() for name in ("x", "y", "yaw")}
    z = None if poses.z is None else poses.z.copy()
    _, frame = np.unique(poses.frame, return_inverse=True)
    for code in range(int(frame.max(initial=-1)) + 1):
        at = np.flatnonzero(frame == code)
        moved = _from_first(poses.x[at], poses.y[at], poses.yaw[at])
        for name, values in zip(("x", "y", "yaw"), moved, strict=True):
            columns[name][at] = values
        if z is not None:
            known = z[at][np.isfinite(z[at])]
            z[at] -= known[0] if len(known) else 0.0
    return replace(poses, t=poses.t - shift, **columns, frame=frame.astype(np.int64), z=z)


def _from_first(x: Floats, y: Floats, yaw: Floats) -> tuple[Floats, Floats, Floats]:
    """Return poses in the frame of the first one: T_first_each."""
    dx, dy, cos, sin = x - x[0], y - y[0], np.cos(yaw[0]), np.sin(yaw[0])
    turned = yaw - yaw[0]
    return cos * dx + sin * dy, cos * dy - sin * dx, np.arctan2(np.sin(turned), np.cos(turned))


def _extra(extra: Mapping[str, NDArray[Any]], shift: float, kept: Collection[str]) -> dict[str, NDArray[Any]]:
    chosen = {name: values for name, values in extra.items() if name in kept}
    if chosen and "t" in extra:
        chosen["t"] = np.asarray(extra["t"], dtype=np.float64) - shift
    return chosen

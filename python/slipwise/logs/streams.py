# SPDX-License-Identifier: Apache-2.0
"""Raw samples of one stream, and how they become clean inputs and poses; used for tables and bags alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.findings.finding import RefusedLogError
from slipwise.logs.findings.readings import AbsurdSpeeds, NotInSeconds
from slipwise.logs.fixes import NO_FIX
from slipwise.logs.left_out import Tally
from slipwise.logs.log import ABSURD, OPTIONAL_POSE_COLUMNS, Bools, Floats, Forces, Inputs, Ints, Poses
from slipwise.logs.stamps import BACKWARD, GOES_BACK, LATEST, forward_stamps, unit_advice

INCOMPLETE = "with a number missing or impossible"
WITHOUT_FIX = "of which the receiver has no fix"
_TOO_MANY_ABSURD = 0.1  # part of a stream; more absurd samples than this are no accident
_STEEPEST = 2.0 * np.pi  # [rad] a roll or pitch beyond a whole turn is no angle
NOMINAL = 20.0  # m/s or rad/s: a command, or the first sample, that is slower is always accepted
STEP = 5.0  # m/s or rad/s: wheels that are measured, and slower, are always accepted
FASTEST = 100.0  # m/s or rad/s: what is slower is accepted once it comes twice in a row
LEAP = 15.0  # anything is accepted up to this many times the fastest sample before it
_TWICE = 2.0  # a sample at most this many times the one before confirms it


@dataclass(frozen=True, eq=False)
class RawStream:
    """Samples of one stream of one run in the order of the file, before anything is left out.

    `place` says where the sample with a given number in `rows` is.
    """

    name: str  # "commands", "wheels" or "poses"
    t: Floats  # [N] s, may hold anything
    columns: dict[str, Floats]  # [N] each; those in `optional` may be NaN
    rows: NDArray[np.int64]  # [N]
    place: Callable[[int], str]
    optional: frozenset[str] = field(default_factory=frozenset)
    course: bool = False  # of positions: the yaw is the direction of the path

    def in_time(self, keep: Bools) -> RawStream:
        """Return the samples where `keep` [N] is true in the order of their stamps."""
        own = np.flatnonzero(keep)
        return self.select(own[np.argsort(self.t[own], kind="stable")])

    def in_run(self, number: int, starts: Floats) -> Bools:
        """Return which samples came in a run, [N]; every run but the first starts at one of `starts` [s]."""
        return np.asarray(np.searchsorted(starts, self.t, side="right") == number)

    def select(self, keep: Bools | Ints) -> RawStream:
        """Return the samples where `keep` [N] is true, or at these places."""
        columns = {name: values[keep] for name, values in self.columns.items()}
        return replace(self, t=self.t[keep], columns=columns, rows=self.rows[keep])


def clean_stream(stream: RawStream, tally: Tally) -> RawStream:
    """Leave out, and count, samples that are not finite and stamps that are no times or do not go forward.

    Raises:
        LogError: most stamps are in another unit than seconds.
    """
    stream = _without_impossible_stamps(stream, tally)
    finite = np.isfinite(stream.t)
    for name, values in stream.columns.items():
        if name not in stream.optional:
            finite &= np.abs(values) < ABSURD
    stream = _keep(stream, finite, tally, "incomplete", INCOMPLETE)
    keep, duplicate, backward = forward_stamps(stream.t)
    if keep.all():
        return stream
    _count(stream, duplicate, tally, "duplicate-stamp", "with a repeated stamp")
    _count(stream, backward, tally, BACKWARD, GOES_BACK)
    return stream.select(keep)


def to_inputs(stream: RawStream, tally: Tally) -> Inputs | None:
    """Make inputs of the columns v, omega and, if there are, vy and ended; None if nothing is left.

    Raises:
        LogError: most speeds are absurd, so that their unit is wrong.
    """
    clean = _without_absurd_speeds(clean_stream(stream, tally), tally)
    if len(clean.t) == 0:
        return None
    vy = clean.columns.get("vy", np.zeros(len(clean.t)))
    ended = clean.columns.get("ended", np.zeros(len(clean.t))) == 1.0
    return Inputs(
        t=clean.t,
        v=clean.columns["v"],
        vy=vy,
        omega=clean.columns["omega"],
        ended=ended if ended.any() else None,
    )


def to_poses(stream: RawStream, tally: Tally) -> Poses:
    """Make poses of the columns x, y, yaw and whatever else there is; `frame` codes start at 0 in order."""
    clean = clean_stream(stream, tally)
    columns = clean.columns
    frame = order_codes(columns["frame"]) if "frame" in columns else np.zeros(len(clean.t), np.int64)
    given = {name: columns.get(name) for name in OPTIONAL_POSE_COLUMNS}
    others = {name: v if v is None else believed(name, v) for name, v in given.items()}
    others = {name: None if v is None or np.isnan(v).all() else v for name, v in others.items()}
    return Poses(
        t=clean.t,
        x=columns["x"],
        y=columns["y"],
        yaw=columns["yaw"],
        frame=frame,
        course=stream.course,
        **others,
    )


def to_forces(stream: RawStream, tally: Tally) -> Forces | None:
    """Make known forces of the columns force_x and force_y, each held until it is said again."""
    clean = clean_stream(stream, tally)
    if len(clean.t) == 0:
        return None
    x, y = (_held(clean.columns.get(name), len(clean.t)) for name in ("force_x", "force_y"))
    return Forces(clean.t, x, y)


def _held(values: Floats | None, count: int) -> Floats:
    """Return the last number that was said, 0 before the first."""
    if values is None:
        return np.zeros(count)
    last = np.maximum.accumulate(np.where(np.isfinite(values), np.arange(count), -1))
    return np.where(last >= 0, np.nan_to_num(values)[np.maximum(last, 0)], 0.0)


def believed(name: str, values: Floats) -> Floats:
    """Return what is measured beside a pose [N], NaN where it is no such measurement."""
    if name in ("std_xy", "std_yaw"):  # 0 and less is how many programs write that it is not known
        return np.where((values > 0.0) & (values < ABSURD), values, np.nan)
    return np.where(np.abs(values) < (_STEEPEST if name in ("roll", "pitch") else ABSURD), values, np.nan)


def without_fix(stream: RawStream, tally: Tally) -> RawStream:
    """Leave out, and count, positions of which the receiver says that it has none."""
    if "fix" not in stream.columns:
        return stream
    return _keep(stream, stream.columns["fix"] != NO_FIX, tally, "no-fix", WITHOUT_FIX)


def _without_absurd_speeds(stream: RawStream, tally: Tally) -> RawStream:
    absurd = np.zeros(len(stream.t), bool)
    for values in stream.columns.values():
        absurd |= absurd_speeds(values, measured=stream.name == "wheels")
    count = int(absurd.sum())
    if count > 3 and count > _TOO_MANY_ABSURD * len(absurd):
        what = f"{count} of {len(absurd)} {stream.name} are faster than {FASTEST:g} m/s or rad/s"
        where = stream.place(int(stream.rows[np.argmax(absurd)]))
        advice = "convert speeds to m/s and yaw rates to rad/s"
        raise RefusedLogError(AbsurdSpeeds.found(what, advice, evidence=count), where)
    return _keep(stream, ~absurd, tally, "absurd-speed", "far beyond all speeds before, all at once")


def _without_impossible_stamps(stream: RawStream, tally: Tally) -> RawStream:
    beyond = np.abs(stream.t) > LATEST  # false for NaN
    if beyond.sum() > 0.5 * len(beyond):
        usual = float(np.median(np.abs(stream.t[beyond])))
        where = stream.place(int(stream.rows[np.argmax(beyond)]))
        what = f"stamps of {stream.name} are about {usual:.2g}"
        raise RefusedLogError(NotInSeconds.found(what, unit_advice(usual), evidence=usual), where)
    return _keep(stream, ~beyond, tally, "bad-stamp", "whose stamp is not a time in seconds")


def order_codes(values: NDArray[np.float64] | Ints) -> Ints:
    """Number the distinct values [N] from 0 in the order in which they first appear."""
    _, first, inverse = np.unique(values, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[inverse], dtype=np.int64)


def _keep(stream: RawStream, keep: Bools, tally: Tally, kind: str, reason: str) -> RawStream:
    if keep.all():
        return stream
    _count(stream, ~keep, tally, kind, reason)
    return stream.select(keep)


def _count(stream: RawStream, wrong: Bools, tally: Tally, kind: str, reason: str) -> None:
    if wrong.any():
        where = stream.place(int(stream.rows[np.argmax(wrong)]))
        tally.add(kind, f"{stream.name} {reason}", count=int(wrong.sum()), where=where)


def absurd_speeds(values: Floats, *, measured: bool = False) -> Bools:
    """Say which samples of a stream are absurd.

    A sample is absurd if faster than `NOMINAL`, more than `LEAP` times as fast as all that were accepted
    before it, and either faster than `FASTEST` or alone. Wheels do not step as commands may: for them `STEP`
    stands in the place of `NOMINAL`, after the first sample. So a spike of a few times what is usual stays, a
    log that starts at full speed loses its first sample, and no sample is judged by a later one.

    Args:
        values: one column of a stream [N] in m/s or rad/s, all finite, in order of time.
        measured: these are speeds of wheels, not commands.
    """
    size = np.abs(values)
    absurd = np.zeros(len(values), bool)
    usual = STEP if measured else NOMINAL
    fast = np.flatnonzero(size > usual)
    if len(fast) == 0:
        return absurd
    slow = np.maximum.accumulate(np.where(size > usual, 0.0, size))  # the fastest that is always accepted
    believed = int(np.argmax(size <= usual)) if len(fast) < len(size) else len(size)  # the first accepted
    fastest = 0.0  # of the others that were accepted
    for i in fast.tolist():
        near = size[i] <= (NOMINAL if i < believed else max(usual, LEAP * max(float(slow[i]), fastest)))
        confirmed = i > 0 and size[i] <= min(FASTEST, _TWICE * size[i - 1])
        if not (near or confirmed):
            absurd[i] = True
            continue
        if confirmed or i > believed:  # nothing stands for the very first
            fastest = max(fastest, float(size[i]))
        believed = min(believed, i)
    return absurd

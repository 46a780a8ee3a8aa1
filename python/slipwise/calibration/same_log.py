# SPDX-License-Identifier: Apache-2.0
"""Logs that are learned a second time: their SHA-256 or their poses say it, whatever files are called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.findings.finding import Finding

if TYPE_CHECKING:
    from slipwise.logs.log import Bools, Floats, Log, Run
    from slipwise.models.model import Model

_ALIKE = 0.5  # of the poses of a run
_AGAIN = 1.0 / 3.0  # of the poses of a run: a drive and half of it again
_FEWEST = 20  # poses at other places, with fewer of which nothing is said
_TWICE = "what it has seen of it counts twice, standard deviations are too small, and figures prove little"


def refuse_same_log(log: Log) -> None:
    """Refuse files that were joined to one log, where two of them hold the same drive, or one holds it twice.

    Parts of one file that lie at other times are other drives, unless their poses are the same to the bit.

    Raises:
        LogError: a file is given twice, or a copy of it, or poses of one come again in their order.
    """
    counted = Counter(source.sha256 for source in log.sources)
    again = {source.path: source.sha256 for source in log.sources if counted[source.sha256] > 1}
    seen: dict[tuple[str, bytes], str] = {}
    for run in log.runs:
        path = run.files[0] if run.files else ""
        if path not in again:
            continue
        drive = again[path], _measured(run)
        if drive in seen:
            what = "a log is given twice" if seen[drive] == path else f"the same log as {seen[drive]}"
            raise LogError(what, where=path, advice="give it once")
        seen[drive] = path
    _refuse_same_poses(log)
    for path in dict.fromkeys(run.files[0] for run in log.runs if run.files):
        _refuse_repeated_poses([run for run in log.runs if run.files[:1] == (path,)])


def _refuse_same_poses(log: Log) -> None:
    """Refuse a file half of whose poses are those of another, by stamps and places: a part, or edited."""
    held_by: dict[bytes, str] = {}
    for run in log.runs if len(log.sources) > 1 else ():
        path = run.files[0] if run.files else ""
        places = _places(run)
        before = Counter(held_by[place] for place in places if place in held_by)
        for other, number in before.most_common(1):
            if other != path and number >= max(_FEWEST, _ALIKE * len(places)):
                raise LogError(f"the same drive as in {other}", where=path, advice="give it once")
        for place in places if path else ():
            held_by.setdefault(place, path)


def _places(run: Run) -> set[bytes]:
    """Return where a run was when, as bytes of stamps with places; of a robot that stands, the first."""
    rows = np.column_stack((run.poses.t, run.poses.x, run.poses.y))
    return {row.tobytes() for row in rows[_changed(rows[:, 1:])]}


def _refuse_repeated_poses(runs: Sequence[Run]) -> None:
    """Refuse runs of one file that hold a drive twice: poses that come again in their order, to the bit."""
    moving = [_moving(run) for run in runs]
    rows = np.concatenate((np.empty((0, 4)), *moving))
    owner = np.repeat(np.arange(len(moving)), [len(each) for each in moving])
    start, length, back = _longest_again(rows[:, 1:])
    if length < _FEWEST or length < _AGAIN * len(moving[owner[start]]):
        return
    later, earlier = (runs[owner[row]] for row in (start, start - back))
    t, before = rows[start, 0] - later.span[0], rows[start - back, 0] - earlier.span[0]
    of = "" if later is earlier else f" of run {earlier.name}"
    raise LogError(
        f"a drive is there twice: from {t:.1f} s on the poses are those from {before:.1f} s{of} again",
        where=", ".join((*later.files[:1], f"run {later.name}")),
        advice="keep one of the two",
    )


def _moving(run: Run) -> Floats:
    """Return rows of (t, x, y, yaw), the yaw zero where positions alone were measured; without standing."""
    rows = np.nan_to_num(run.poses.rows()[:, :4])
    return rows[_changed(rows[:, 1:])]


def _changed(rows: Floats) -> Bools:
    """Return which rows differ from the one before, [N]; the first one does."""
    changed = np.ones(len(rows), np.bool_)
    changed[1:] = (np.diff(rows, axis=0) != 0.0).any(axis=1)
    return changed


def _longest_again(rows: Floats) -> tuple[int, int, int]:
    """Return the longest stretch of rows that came before: its first row, how many it has, how far before.

    The distance is the one at which most rows were first seen; then rows are compared with those before.
    Rows count once, so that a robot that stands and flickers between few poses drives nothing again.
    """
    if not len(rows):
        return 0, 0, 0
    order = np.lexsort(rows.T)  # equal rows side by side, the first one first
    other = _changed(rows[order])
    first = np.empty(len(rows), np.int64)
    first[order] = order[other][np.cumsum(other) - 1]
    seen = np.bincount(np.arange(len(rows)) - first)
    seen[:_FEWEST] = 0
    back = int(seen.argmax())
    if back == 0:
        return 0, 0, 0
    same = np.concatenate(([False], (rows[back:] == rows[:-back]).all(axis=1), [False]))
    edges = np.flatnonzero(np.diff(same)).reshape(-1, 2)
    begin, end = edges[np.diff(edges, axis=1)[:, 0].argmax()].tolist()
    return begin + back, len(np.unique(first[begin:end])), back


def _measured(run: Run) -> bytes:
    """Return what tells drives of one file apart: stamps, positions and inputs."""
    columns = [run.poses.t, run.poses.x, run.poses.y]
    for inputs in (run.commands, run.wheels):
        columns += [] if inputs is None else [inputs.t, inputs.v, inputs.omega]
    return b"".join(column.tobytes() for column in columns)


def learned_from(log: Log, model: Model) -> tuple[str, ...]:
    """Return the files of a log that a model has learned from; predictions of these are not causal."""
    return _files(log, _learned(model))


def learned_before(log: Log, start: Model | None) -> tuple[Finding, ...]:
    """Return what is to be said where learning goes on, on a log that the model to begin with has learned."""
    return () if start is None else learned_again(log, _learned(start), "the model to begin with")


def learned_again(log: Log, known: Collection[str], who: str) -> tuple[Finding, ...]:
    """Return what is to be said where `who` has learned files of a log already, by their SHA-256."""
    again = _files(log, known)
    if not again:
        return ()
    sentence = f"{who} has learned {', '.join(again)} already: {_TWICE}"
    advice = "Go on with logs that it has not learned, or with other parts of them (--start, --end)."
    return (Finding("learned-before", sentence, (advice,), spoils=False, reserves=True),)


def logs_of_both(first: Model, second: Model) -> tuple[str, ...]:
    """Return the logs of the first model, by their paths, that the second has learned too."""
    hashes = _learned(second)
    return tuple(each.path for each in first.content.provenance.logs if each.sha256 in hashes)


def _files(log: Log, hashes: Collection[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(source.path for source in log.sources if source.sha256 in hashes))


def _learned(model: Model) -> set[str]:
    return {reference.sha256 for reference in model.content.provenance.logs}


def twice_in_both(logs: tuple[str, ...]) -> str:
    """Say what it means that two models whose surfaces are joined have learned from the same logs."""
    return (
        f"Both models have learned {', '.join(logs)}, which counts twice: standard deviations of surfaces "
        "that became one are too small. Join models that have no log in common."
    )

# SPDX-License-Identifier: Apache-2.0
"""Learns every log of a fleet that is new, keeps its rows, and says how long the rest takes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from slipwise.addresses import masked, remote_url, shown
from slipwise.calibration import Settings, load_settings
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import LogRows, key_of, log_hash, settings_hash
from slipwise.fleet.process_scheduler import Scheduler
from slipwise.fleet.store import Store


@dataclass(frozen=True)
class Progress:
    """How far a fleet is learned."""

    done: int
    of: int
    seconds_left: float


@dataclass(frozen=True)
class Count:
    """What came of a run over a fleet's logs."""

    learned: int
    known: int  # from an earlier run
    unusable: int  # with a reason that is kept
    failed: tuple[tuple[str, str], ...]  # log and why; tried again by the next run
    copies: tuple[tuple[str, str], ...]  # log, and what says that another one is the same


def learn_fleet(
    logs: Sequence[tuple[Path, str]],
    store: Store,
    scheduler: Scheduler,
    *,
    settings: Path | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Count:
    """Learn the logs that are not in the store yet; each one's file is written as soon as it is learned.

    Args:
        logs: paths and vehicles, as `find_logs` returns them.
        store: where rows are kept.
        scheduler: who learns.
        settings: a TOML file of settings of learning.
        progress: called after each log.

    Raises:
        OutputError: a file cannot be written.
    """
    work = _Work(logs, store, settings)
    began = time.monotonic()
    learned = unusable = 0
    failed: list[tuple[str, str]] = []
    with closing(scheduler.run(work.tasks())) as outcomes:
        for outcome in outcomes:
            if outcome.rows is None or not outcome.rows.key:
                failed.append((shown(outcome.task.path), masked(outcome.failure)))
            elif work.is_new(outcome.task, outcome.rows):
                store.add(outcome.rows)
                learned, unusable = learned + bool(outcome.rows.rows), unusable + (not outcome.rows.rows)
            if progress is not None:
                done = learned + unusable + len(failed)
                left = len(logs) - done - work.known - len(work.unreadable)
                each = (time.monotonic() - began) / max(done, 1)
                progress(Progress(len(logs) - left, len(logs), each * left))
    return Count(learned, work.known, unusable, (*failed, *work.unreadable), tuple(work.copies))


class _Work:
    """The tasks of the logs that are new, made one by one as workers are free."""

    def __init__(self, logs: Sequence[tuple[Path, str]], store: Store, settings: Path | None) -> None:
        self.known = 0
        self.unreadable: list[tuple[str, str]] = []
        self.copies: list[tuple[str, str]] = []
        self._came: dict[str, tuple[str, str]] = {}  # path and vehicle of the first log of each key
        self._logs, self._store, self._done = logs, store, set(store.keys())
        self._file = "" if settings is None else str(settings.absolute())
        self._hash = settings_hash(Settings() if settings is None else load_settings(settings))

    def tasks(self) -> Iterator[LogTask]:
        """Yield one task per log whose bytes were not learned with these settings, or that is on a server."""
        for path, vehicle in self._logs:
            url = remote_url(path)
            if url is not None:
                digest, tag = self._store.address(url)
                before = (digest, tag) if key_of(digest, self._hash) in self._done else ("", "")
                yield LogTask(url, vehicle, self._file, *before)
                continue
            try:
                digest = log_hash(path)
            except OSError as problem:
                self.unreadable.append((str(path), f"cannot read: {problem.strerror}"))
                continue
            key = key_of(digest, self._hash)
            self._note(key, str(path), vehicle)
            if key in self._done:
                self.known += 1
                continue
            self._done.add(key)  # a copy of a log is the same log
            yield LogTask(str(path.absolute()), vehicle, self._file, digest)

    def is_new(self, task: LogTask, rows: LogRows) -> bool:
        """Say whether what came is to be kept; of a log on a server only now its bytes are known."""
        url = remote_url(task.path)
        if url is None:
            return True
        if not rows.known or rows.tag != task.tag:
            self._store.add_address(url, rows.log_sha256, rows.tag)
        self._note(rows.key, shown(url), task.vehicle)
        if rows.key in self._done:
            self.known += 1
            return False
        self._done.add(rows.key)
        return True

    def _note(self, key: str, path: str, vehicle: str) -> None:
        """Note that a log came, which may be one that came before."""
        first, of = self._came.setdefault(key, (path, vehicle))
        if first != path:
            once = "" if of == vehicle else f", and counts once, not for both {of} and {vehicle}"
            self.copies.append((path, f"the same log as {first}{once}"))

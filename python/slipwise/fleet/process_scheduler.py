# SPDX-License-Identifier: Apache-2.0
"""Schedulers hand many logs to workers; the one here learns them in processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Protocol

from slipwise.errors import SettingsError
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import LogRows, learn_task
from slipwise.stop_signals import kept_from_children

PATIENCE = 10.0  # s for a worker to end
Work = Callable[[LogTask], LogRows]
DIED = "the worker died on this log"
ATTEMPTS = 2  # a log that kills its worker this often is left out


class ProcessScheduler:
    """One pool of a single process per worker, so that a death is known to be of one log.

    Args:
        workers: how many; by default one per processor.
        work: what is done with a task; a function of a module.

    Raises:
        SettingsError: fewer than one worker.
    """

    def __init__(self, workers: int | None = None, *, work: Work = learn_task) -> None:
        if workers is not None and workers < 1:
            raise SettingsError(
                f"{workers} processes learn nothing", where="workers", advice="give 1 or more"
            )
        self._workers = workers or os.cpu_count() or 1
        self._work = work

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        """Yield the outcome of each task as it is done."""
        with tempfile.TemporaryDirectory(prefix="slipwise-", ignore_cleanup_errors=True) as folder:
            yield from self._run(iter(tasks), folder)

    def _run(self, waiting: Iterator[LogTask], folder: str) -> Generator[Outcome, None, None]:
        free = [_pool(folder) for _ in range(self._workers)]
        running: dict[Future[LogRows], tuple[ProcessPoolExecutor, LogTask, int]] = {}
        try:
            while True:
                while free and (task := next(waiting, None)) is not None:
                    pool = free.pop()
                    running[self._submit(pool, task)] = pool, task, 1
                if not running:
                    return
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    pool, task, attempt = running.pop(future)
                    problem = future.exception()
                    if isinstance(problem, BrokenProcessPool):
                        pool.shutdown(wait=False)
                        pool = _pool(folder)
                        if attempt < ATTEMPTS:
                            running[self._submit(pool, task)] = pool, task, attempt + 1
                            continue
                    free.append(pool)
                    yield _outcome(task, future, problem)
        finally:
            _end([*free, *(pool for pool, _, _ in running.values())])

    def _submit(self, pool: ProcessPoolExecutor, task: LogTask) -> Future[LogRows]:
        with kept_from_children():  # the first task starts the process
            return pool.submit(self._work, task)


def _pool(folder: str) -> ProcessPoolExecutor:
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=_begin, initargs=(folder,))


def _begin(folder: str) -> None:
    """Leave to the parent the temporary files of a worker that is killed."""
    tempfile.tempdir = folder


def _outcome(task: LogTask, future: Future[LogRows], problem: BaseException | None) -> Outcome:
    if problem is None:
        rows = future.result()
        return Outcome(task, rows, rows.failure)
    if isinstance(problem, BrokenProcessPool):
        return Outcome(task, None, DIED)
    return Outcome(task, None, f"{type(problem).__name__}: {problem}")


def _end(pools: Iterable[ProcessPoolExecutor]) -> None:
    for pool in pools:
        processes = list((pool._processes or {}).values())  # noqa: SLF001 - no public way to end one at work
        pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()
        for process in processes:
            process.join(PATIENCE)


@dataclass(frozen=True)
class Outcome:
    """What came of one log: rows, or the reason why there are none."""

    task: LogTask
    rows: LogRows | None
    failure: str = ""


class Scheduler(Protocol):
    """Runs `learn_task` on every task, somewhere."""

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        """Yield the outcome of each task as it is done, in any order.

        A worker that dies costs its own log only. Closing the iterator ends the workers.
        """
        ...

# SPDX-License-Identifier: Apache-2.0
"""Makes the exhibits of all chapters in two processes."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.thesis.bench import FULL, Bench, BenchSize, load_simulator
from slipwise.thesis.chapter2 import chapter2_exhibits
from slipwise.thesis.chapter3 import chapter3_exhibits
from slipwise.thesis.chapter4 import chapter4_exhibits
from slipwise.thesis.chapter5 import chapter5_exhibits
from slipwise.thesis.chapter6 import chapter6_exhibits
from slipwise.thesis.consistency import consistency_exhibits
from slipwise.thesis.exhibit import Exhibit
from slipwise.thesis.real_logs import real_log_exhibits

if TYPE_CHECKING:
    from multiprocessing.queues import SimpleQueue

Progress = Callable[[str, float], None]  # what is being done, and which share of it is done, 0 to 1
MakeExhibits = Callable[[Bench, Progress], list[Exhibit]]
WORKERS = 2
POLL = 0.2  # [s] between looks at what the workers report


@dataclass(frozen=True)
class Chapter:
    """A part of the reproduction; `make_exhibits` is a function of a module, called in another process."""

    key: str  # for `--only`, as "chapter-4"
    title: str
    make_exhibits: MakeExhibits


@dataclass(frozen=True)
class ChapterResult:
    """The exhibits of a chapter."""

    key: str
    title: str
    exhibits: tuple[Exhibit, ...]


CHAPTERS = (
    Chapter("chapter-2", "Chapter 2: related work", chapter2_exhibits),
    Chapter("chapter-3", "Chapter 3: the vehicle's dynamics", chapter3_exhibits),
    Chapter("chapter-4", "Chapter 4: steady state", chapter4_exhibits),
    Chapter("chapter-5", "Chapter 5: slip surfaces", chapter5_exhibits),
    Chapter("chapter-6", "Chapter 6: transient dynamics", chapter6_exhibits),
    Chapter("real-logs", "Beyond: all methods on real logs", real_log_exhibits),
    Chapter("consistency", "Beyond: is the stated uncertainty true?", consistency_exhibits),
)


@dataclass(frozen=True)
class BenchPlan:
    """What a worker makes its bench from."""

    seed: int = 1
    data: Path | None = None  # folder of real logs
    size: BenchSize = FULL


def chosen_chapters(only: Sequence[str], chapters: Sequence[Chapter] = CHAPTERS) -> tuple[Chapter, ...]:
    """Return the chapters of these keys, all where there are none, in their own order.

    Raises:
        SettingsError: there is no such chapter.
    """
    known = [chapter.key for chapter in chapters]
    for key in only:
        if key not in known:
            raise SettingsError(
                f"unknown chapter '{key}'", where="--only", advice=f"known are {', '.join(known)}"
            )
    return tuple(chapter for chapter in chapters if not only or chapter.key in only)


def reproduce(
    plan: BenchPlan,
    *,
    chapters: Sequence[Chapter] = CHAPTERS,
    progress: Progress = lambda _what, _share: None,
) -> tuple[ChapterResult, ...]:
    """Make the exhibits; the same plan gives the same exhibits, but for times that were measured.

    Args:
        plan: seed, folder of real logs, and size of the simulated drives.
        chapters: which to make.
        progress: told what is being done and which share of the whole is done, 0 to 1.

    Raises:
        SlipwiseError: an extra is not installed, a log cannot be read, or a worker was ended from outside.
    """
    if plan.seed < 0:
        raise SettingsError(f"the seed is {plan.seed}", where="seed", advice="give a whole number from 0 up")
    context = multiprocessing.get_context("spawn")  # forked processes hang in libraries that use threads
    reports = context.SimpleQueue()  # written to before a chapter's result is: no report comes too late
    others = set(multiprocessing.active_children())
    with ProcessPoolExecutor(
        WORKERS, mp_context=context, initializer=_start, initargs=(plan, reports)
    ) as pool:
        try:
            futures = [pool.submit(_make, chapter) for chapter in chapters]
            _follow(futures, reports, progress)
            made = [future.result() for future in futures]
        except BaseException as error:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in set(multiprocessing.active_children()) - others:
                child.terminate()
            if isinstance(error, BrokenProcessPool):
                raise SlipwiseError(
                    "a worker ended early", advice="this is how a machine without enough memory behaves"
                ) from error
            raise
    progress("done", 1.0)
    return tuple(
        ChapterResult(chapter.key, chapter.title, tuple(exhibits))
        for chapter, exhibits in zip(chapters, made, strict=True)
    )


def _follow(
    futures: Sequence[Future[list[Exhibit]]], reports: SimpleQueue[tuple[str, str, float]], progress: Progress
) -> None:
    """Report progress until all futures are done or one has failed."""
    shares: dict[str, float] = {}
    waiting = True
    while waiting:
        done = wait(futures, timeout=POLL).done
        waiting = len(done) < len(futures) and not any(future.exception() for future in done)
        while not reports.empty():
            key, what, share = reports.get()
            shares[key] = max(share, shares.get(key, 0.0))
            progress(f"{key}: {what}", sum(shares.values()) / len(futures))


class _Worker:
    """What a worker process keeps from chapter to chapter."""

    bench: Bench
    reports: SimpleQueue[tuple[str, str, float]]


def _start(plan: BenchPlan, reports: SimpleQueue[tuple[str, str, float]]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all; the parent ends the workers
    load_simulator()
    _Worker.bench = Bench(seed=plan.seed, data=plan.data, size=plan.size)
    _Worker.reports = reports


def _make(chapter: Chapter) -> list[Exhibit]:
    def progress(what: str, share: float) -> None:
        _Worker.reports.put((chapter.key, what, share))

    exhibits = chapter.make_exhibits(_Worker.bench, progress)
    progress("done", 1.0)
    return exhibits

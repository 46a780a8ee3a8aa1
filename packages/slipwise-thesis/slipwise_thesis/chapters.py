# SPDX-License-Identifier: Apache-2.0
"""Makes the figures and tables of all chapters in two processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.stop_signals import kept_from_children
from slipwise_thesis.chapter2 import chapter2_figures
from slipwise_thesis.chapter3 import chapter3_figures
from slipwise_thesis.chapter4 import chapter4_figures
from slipwise_thesis.chapter5 import chapter5_figures
from slipwise_thesis.chapter6 import chapter6_figures
from slipwise_thesis.consistency import consistency_figures
from slipwise_thesis.fixture import FULL, Fixture, FixtureSize, load_simulator
from slipwise_thesis.real_logs import real_log_figures
from slipwise_thesis.thesis_figure import ThesisFigure

if TYPE_CHECKING:
    from multiprocessing.queues import SimpleQueue

Progress = Callable[[str, float], None]  # what is being done, and which fraction of it is done, 0 to 1
MakeFigures = Callable[[Fixture, Progress], list[ThesisFigure]]
WORKERS = 2
POLL = 0.2  # [s] between looks at what the workers report


@dataclass(frozen=True)
class Chapter:
    """A part of the reproduction; `make_figures` is a function of a module, called in another process."""

    key: str  # for `--only`, as "chapter-4"
    title: str
    make_figures: MakeFigures


@dataclass(frozen=True)
class ChapterResult:
    """The figures and tables of a chapter."""

    key: str
    title: str
    figures: tuple[ThesisFigure, ...]


CHAPTERS = (
    Chapter("chapter-2", "Chapter 2: related work", chapter2_figures),
    Chapter("chapter-3", "Chapter 3: the vehicle's dynamics", chapter3_figures),
    Chapter("chapter-4", "Chapter 4: steady state", chapter4_figures),
    Chapter("chapter-5", "Chapter 5: slip surfaces", chapter5_figures),
    Chapter("chapter-6", "Chapter 6: transient dynamics", chapter6_figures),
    Chapter("real-logs", "Beyond: all methods on real logs", real_log_figures),
    Chapter("consistency", "Beyond: is the reported uncertainty true?", consistency_figures),
)


@dataclass(frozen=True)
class FixturePlan:
    """What a worker makes its fixture from."""

    seed: int = 1
    data: Path | None = None  # folder of real logs
    size: FixtureSize = FULL


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
    plan: FixturePlan,
    *,
    chapters: Sequence[Chapter] = CHAPTERS,
    progress: Progress = lambda _what, _share: None,
) -> tuple[ChapterResult, ...]:
    """Make the figures and tables; the same plan gives the same ones, but for times that were measured.

    Args:
        plan: seed, folder of real logs, and size of the simulated drives.
        chapters: which to make.
        progress: called with what is being done and which fraction of the whole is done, 0 to 1.

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
            with kept_from_children():
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
        ChapterResult(chapter.key, chapter.title, tuple(figures))
        for chapter, figures in zip(chapters, made, strict=True)
    )


def _follow(
    futures: Sequence[Future[list[ThesisFigure]]],
    reports: SimpleQueue[tuple[str, str, float]],
    progress: Progress,
) -> None:
    """Report progress until all futures are done or one has failed."""
    fractions: dict[str, float] = {}
    waiting = True
    while waiting:
        done = wait(futures, timeout=POLL).done
        waiting = len(done) < len(futures) and not any(future.exception() for future in done)
        while not reports.empty():
            key, what, fraction = reports.get()
            fractions[key] = max(fraction, fractions.get(key, 0.0))
            progress(f"{key}: {what}", sum(fractions.values()) / len(futures))


class _Worker:
    """What a worker process keeps from chapter to chapter."""

    fixture: Fixture
    reports: SimpleQueue[tuple[str, str, float]]


def _start(plan: FixturePlan, reports: SimpleQueue[tuple[str, str, float]]) -> None:
    load_simulator()
    _Worker.fixture = Fixture(seed=plan.seed, data=plan.data, size=plan.size)
    _Worker.reports = reports


def _make(chapter: Chapter) -> list[ThesisFigure]:
    def progress(what: str, fraction: float) -> None:
        _Worker.reports.put((chapter.key, what, fraction))

    figures = chapter.make_figures(_Worker.fixture, progress)
    progress("done", 1.0)
    return figures

# SPDX-License-Identifier: Apache-2.0
"""Processes learn all logs; one that dies or fails costs its own log only."""

from __future__ import annotations

from pathlib import Path

import pytest
from fleet.work_samples import DIES, DIES_ONCE, FAILS, sample_task, sample_work

from slipwise.fleet import ProcessScheduler
from slipwise.fleet.process_scheduler import DIED

pytestmark = pytest.mark.slow


@pytest.fixture
def scheduler(monkeypatch: pytest.MonkeyPatch) -> ProcessScheduler:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).resolve().parents[1]))  # of the workers
    return ProcessScheduler(2, work=sample_work)


def test_every_log_is_learned_once(scheduler: ProcessScheduler) -> None:
    outcomes = list(scheduler.run(sample_task(f"log-{k}") for k in range(7)))
    assert sorted(outcome.task.path for outcome in outcomes) == [f"log-{k}" for k in range(7)]
    assert all(outcome.rows is not None and outcome.rows.log == outcome.task.path for outcome in outcomes)


def test_killed_worker_costs_its_log_only(scheduler: ProcessScheduler) -> None:
    names = ["a", "b", DIES, "c", FAILS, "d", "e"]
    outcomes = {outcome.task.path: outcome for outcome in scheduler.run(map(sample_task, names))}
    assert sorted(outcomes) == sorted(names)
    assert outcomes[DIES].failure == DIED
    assert outcomes[FAILS].failure == "ValueError: as it was told"
    assert all(outcomes[name].rows is not None for name in "abcde")


def test_log_of_a_killed_worker_is_tried_again(scheduler: ProcessScheduler, tmp_path: Path) -> None:
    (outcome,) = scheduler.run([sample_task(str(tmp_path / DIES_ONCE))])
    assert outcome.rows is not None
    assert (tmp_path / f"{DIES_ONCE}.died").exists()


def test_closing_ends_the_workers(scheduler: ProcessScheduler) -> None:
    asked = []
    tasks = (asked.append(k) or sample_task(f"log-{k}") for k in range(1000))  # type: ignore[func-returns-value]
    outcomes = scheduler.run(tasks)
    next(outcomes)
    outcomes.close()
    assert len(asked) < 10

# SPDX-License-Identifier: Apache-2.0
"""What learns many logs at once: a scheduler hands each to a worker and yields what came of it."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import dataclass
from typing import Protocol

from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import LogRows

DIED = "the worker died on this log"
ATTEMPTS = 2  # a log that kills its worker this often is left out


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

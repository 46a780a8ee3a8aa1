# SPDX-License-Identifier: Apache-2.0
"""Learns logs on a Dask cluster, whose workers must see the logs under the same paths."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from typing import Any

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.extras import to_install
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import LogRows, learn_task
from slipwise.fleet.process_scheduler import DIED, Outcome

AT_ONCE = 1000  # tasks that the cluster is given ahead, so that the driver's memory stays bounded
PATIENCE = 20.0  # s until a scheduler that does not answer counts as not there


class DaskScheduler:
    """A running cluster, which does a dead worker's logs again by itself.

    Args:
        address: of its scheduler, such as tcp://10.0.0.1:8786.
        work: what is done with a task; a function of a module that the workers can import.

    Raises:
        SlipwiseError: Dask is not installed.
        SettingsError: there is no scheduler at that address.
    """

    def __init__(self, address: str, *, work: Callable[[LogTask], LogRows] = learn_task) -> None:
        try:
            import distributed
        except ImportError as problem:
            raise SlipwiseError("Dask is not installed", advice=to_install("fleet")) from problem
        try:
            client: Any = distributed.Client
            self._client: Any = client(address, timeout=PATIENCE)
        except (OSError, ValueError) as problem:
            raise SettingsError(
                "no Dask scheduler answers", where=address, advice="such as tcp://10.0.0.1:8786"
            ) from problem
        self._work = work

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        """Yield the outcome of each task as it is done."""
        import distributed

        waiting = iter(tasks)
        running: dict[Any, LogTask] = {}
        try:
            done: Any = distributed.as_completed()  # type: ignore[no-untyped-call,unused-ignore]
            for task in waiting:
                self._submit(task, running, done)
                if len(running) >= AT_ONCE:
                    break
            while running:
                future = next(done)
                task = running.pop(future)
                if (following := next(waiting, None)) is not None:
                    self._submit(following, running, done)
                yield _outcome(task, future)
        finally:
            self._client.cancel(list(running))
            self._client.close()

    def _submit(self, task: LogTask, running: dict[Any, LogTask], done: Any) -> None:
        future = self._client.submit(self._work, task, pure=False)
        running[future] = task
        done.add(future)


def _outcome(task: LogTask, future: Any) -> Outcome:
    problem = future.exception()
    if problem is None:
        rows: LogRows = future.result()
        return Outcome(task, rows, rows.failure)
    died = type(problem).__name__ == "KilledWorker"
    return Outcome(task, None, DIED if died else f"{type(problem).__name__}: {problem}")

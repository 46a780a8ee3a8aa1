# SPDX-License-Identifier: Apache-2.0
"""Learns logs on a Ray cluster or a Ray of this machine; workers must see the logs under the same paths."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from itertools import islice
from typing import Any

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import LogRows, learn_task
from slipwise.fleet.scheduler import ATTEMPTS, DIED, Outcome

RAY = "ray"  # in place of an address: what RAY_ADDRESS names, or else a Ray of this machine
AT_ONCE = 1000  # tasks that the cluster is given ahead, so that the driver's memory stays bounded


class RayScheduler:
    """A Ray cluster, which does a dead worker's log again by itself, one processor a log.

    Args:
        address: of Ray's client server, such as ray://10.0.0.1:10001, or `RAY`.
        work: what is done with a task; a function of a module that the workers can import.

    Raises:
        SlipwiseError: Ray is not installed.
        SettingsError: there is no cluster at that address.
    """

    def __init__(self, address: str, *, work: Callable[[LogTask], LogRows] = learn_task) -> None:
        try:
            import ray
        except ImportError as problem:
            raise SlipwiseError("Ray is not installed", advice='pip install "slipwise[ray]"') from problem
        at = None if address == RAY else address
        try:
            ray.init(at, log_to_driver=False, ignore_reinit_error=True)
        except (ConnectionError, OSError, ValueError) as problem:
            said = " ".join(str(problem).split())[:200]
            advice = "such as ray://10.0.0.1:10001, or ray"
            raise SettingsError(f"no Ray cluster answers: {said}", where=address, advice=advice) from problem
        self._ray: Any = ray
        self._work = ray.remote(num_cpus=1, max_retries=ATTEMPTS - 1)(work)

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        """Yield the outcome of each task as it is done."""
        waiting = iter(tasks)
        running: dict[Any, LogTask] = {}
        try:
            while True:
                for task in islice(waiting, AT_ONCE - len(running)):
                    running[self._work.remote(task)] = task
                if not running:
                    return
                (done,), _ = self._ray.wait(list(running), num_returns=1)
                yield self._outcome(running.pop(done), done)
        finally:
            for future in running:
                self._ray.cancel(future, force=True)
            self._ray.shutdown()

    def _outcome(self, task: LogTask, future: Any) -> Outcome:
        try:
            rows: LogRows = self._ray.get(future)
        except (self._ray.exceptions.WorkerCrashedError, self._ray.exceptions.OutOfMemoryError):
            return Outcome(task, None, DIED)
        except Exception as problem:  # whatever the work raised
            cause = getattr(problem, "cause", None) or problem
            return Outcome(task, None, f"{type(cause).__name__}: {cause}")
        return Outcome(task, rows, rows.failure)

# SPDX-License-Identifier: Apache-2.0
"""How `slipwise fleet` grows with its logs: time against the sum of single ones, and what its driver needs.

    python benchmarks/fleet_scale.py learn FOLDER --workers 1 2 --json scale.json
    python benchmarks/fleet_scale.py drive FOLDER --known 10000

`learn` takes the logs that `fleet_logs.py` wrote. It learns each alone in this process, then all by each
number of workers, and compares processor times, start of the workers included. `drive` puts what those logs
gave in place of learning: as many small files as asked are hashed, their rows, jittered by what each is sure
to, come back from worker processes, are stored, tested and drawn; then the same again, when all are known.
Only the learning itself is left out of it, which happens in the workers.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.calibration import Settings
from slipwise.fleet import (
    LogRows,
    LogTask,
    ProcessScheduler,
    Row,
    Store,
    find_logs,
    findings_of,
    learn_task,
    write_prior,
)
from slipwise.fleet.fleet_page import fleet_page
from slipwise.fleet.learn_fleet import Count, learn_fleet
from slipwise.fleet.learned_rows import key_of, log_hash, settings_hash
from slipwise.fleet.vehicle_numbers import VehicleNumbers

TEMPLATES = "FLEET_SCALE_TEMPLATES"  # file of learned rows that workers hand out
LOGS_OF_A_VEHICLE = 50
DAY = 86400.0  # s


def _processor_time() -> float:
    """Return the processor time of this process and of its children that ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _peak() -> float:
    """Return the largest resident memory of this process so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def measure_learning(folder: Path, workers: Sequence[int], templates: Path) -> dict[str, object]:
    """Learn all logs one by one, then together; keep what was learned in a file."""
    logs = find_logs([folder])
    began, learned = _processor_time(), []
    for path, vehicle in logs:
        learned.append(learn_task(LogTask(str(path), vehicle, "", log_hash(path))))
    single = _processor_time() - began
    templates.write_text(json.dumps([asdict(rows) for rows in learned if rows.rows]), encoding="utf-8")
    result: dict[str, object] = {
        "logs": len(logs),
        "hours": sum(rows.seconds for rows in learned) / 3600.0,
        "single_s": single,
        "peak_of_learning_mb": _peak(),
    }
    for count in workers:
        with tempfile.TemporaryDirectory() as out:
            began, clock = _processor_time(), time.monotonic()
            done = learn_fleet(logs, Store(Path(out)), ProcessScheduler(count))
            assert done.learned + done.unusable == len(logs)
            used = _processor_time() - began
            wall = time.monotonic() - clock
        result[f"workers_{count}"] = {"processor_s": used, "wall_s": wall, "over_single": used / single}
    return result


@functools.cache
def _templates(path: str) -> list[LogRows]:
    entries = json.loads(Path(path).read_text(encoding="utf-8"))
    return [
        LogRows(
            **entry
            | {
                "rows": tuple(Row(**row) for row in entry["rows"]),
                "numbers": VehicleNumbers(**entry["numbers"]),
            }
        )
        for entry in entries
    ]


def cached_work(task: LogTask) -> LogRows:
    """Return what another log gave, as that of this one."""
    templates = _templates(os.environ[TEMPLATES])
    number = int(Path(task.path).stem)
    like = templates[number // LOGS_OF_A_VEHICLE % len(templates)]
    random = np.random.default_rng(number)
    day = number % LOGS_OF_A_VEHICLE
    return replace(
        like,
        key=key_of(task.log_sha256, settings_hash(Settings())),
        log=task.path,
        vehicle=task.vehicle,
        month=f"2026-{1 + day // 30:02d}",
        log_sha256=task.log_sha256,
        start=1.7e9 + DAY * day,
        rows=tuple(replace(row, value=row.value + row.std * random.standard_normal()) for row in like.rows),
    )


def measure_driver(count: int, templates: Path) -> dict[str, object]:
    """Put many logs through the driver of a fleet, whose workers hand out rows; time and memory by step."""
    os.environ[TEMPLATES] = str(templates)
    steps: dict[str, object] = {"logs": count, "start_mb": _peak()}
    folder = Path(tempfile.mkdtemp())

    def step(name: str, work: Callable[[], object]) -> object:
        clock, began = time.monotonic(), time.process_time()
        done = work()
        steps[name] = {
            "wall_s": time.monotonic() - clock,
            "processor_s": time.process_time() - began,
            "peak_mb": _peak(),
        }
        return done

    try:
        for number in range(count):
            path = folder / f"v{number // LOGS_OF_A_VEHICLE:04d}" / f"{number:07d}.csv"
            path.parent.mkdir(exist_ok=True)
            path.write_text(f"{number}\n", encoding="utf-8")
        store = Store(folder / "out")
        logs = find_logs([folder])
        step("learn", lambda: learn_fleet(logs, store, ProcessScheduler(1, work=cached_work)))
        _look(store, step)
        again = step("again", lambda: learn_fleet(logs, store, ProcessScheduler(1, work=cached_work)))
        assert isinstance(again, Count)
        assert again.known == count
        files = [path for path in store.folder.rglob("*") if path.is_file()]
        steps["store_mb"] = sum(path.stat().st_size for path in files) / 1e6
    finally:
        shutil.rmtree(folder)
    return steps


def _look(store: Store, step: Callable[[str, Callable[[], object]], object]) -> None:
    """Do what the command does after all is learned."""
    table: Any = step("table", store.table)
    findings: Any = step("findings", lambda: findings_of(table))
    step("page", lambda: fleet_page(table, findings, store.unusable()))
    table.clear()
    step("prior", lambda: write_prior(store.folder / "fleet.yaml", findings, store.knowledge()))


def main() -> int:
    """Measure what the command line asks for and print it as JSON."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("what", choices=("learn", "drive"))
    parser.add_argument("folder", type=Path, help="of the logs; what they gave is kept beside it")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--known", type=int, default=10_000, help="logs that `drive` puts through the driver")
    parser.add_argument("--json", type=Path, help="where the result is written, too")
    asked = parser.parse_args()
    templates = asked.folder.with_name(f"{asked.folder.name}.rows.json")
    if asked.what == "learn":
        result = measure_learning(asked.folder, asked.workers, templates)
    else:
        result = measure_driver(asked.known, templates)
    text = json.dumps(result, indent=1)
    print(text)
    if asked.json is not None:
        asked.json.write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

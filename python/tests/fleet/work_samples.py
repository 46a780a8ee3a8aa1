# SPDX-License-Identifier: Apache-2.0
"""Work for schedulers that takes no log: it counts, fails or dies as the name of the task says."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from slipwise.fleet import LogRows, LogTask, Row

DIES, DIES_ONCE, FAILS = "dies", "dies-once", "fails"


def sample_task(name: str, vehicle: str = "one") -> LogTask:
    """Return a task whose path is `name`."""
    return LogTask(name, vehicle, "", "ab" * 32)


def sample_rows(path: str = "log", **changed: object) -> LogRows:
    """Return what was learned of a log."""
    content: dict[str, object] = {
        "key": "0123456789abcdef-0123456789abcdef",
        "log": path,
        "vehicle": "one",
        "month": "2026-11",
        "log_sha256": "ab" * 32,
        "settings_sha256": "cd" * 32,
        "version": "0",
        "start": 1.7e9,
        "seconds": 60.0,
        "distance": 30.0,
        "input": "command",
        "good": True,
        "verdict": "Good.",
        "rows": (Row("ang.w", "-", -0.3, 0.01, 0.3, True), Row("lon.V", "-", -0.1, 0.02, 0.3, True)),
    }
    return LogRows(**(content | changed))  # type: ignore[arg-type]


def sample_work(task: LogTask) -> LogRows:
    """Do what the task's name says; who dies once leaves a file that says so."""
    kind = Path(task.path).name
    if kind == DIES:
        os.kill(os.getpid(), signal.SIGKILL)
    if kind == DIES_ONCE:
        mark = Path(f"{task.path}.died")
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    if kind == FAILS:
        raise ValueError("as it was told")
    return sample_rows(task.path)

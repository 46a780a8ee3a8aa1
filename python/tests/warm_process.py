# SPDX-License-Identifier: Apache-2.0
"""Commands as processes of their own, each a fork of one that has loaded slipwise: they start in no time.

Run as a program, it is that one: it reads a request a line, and answers with the exit code of its child.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import pkgutil
import resource
import signal
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

LOADED = (
    *("numpy.ma", "numpy.random", "pyarrow.compute", "pyarrow.csv", "pyarrow.parquet", "rich.console"),
    *("apsw", "lz4.frame", "rosbags.rosbag2", "rosbags.typesys.stores.ros2_humble", "rich.table", "yaml"),
    *("slipwise.api", "slipwise.calibration.calibrate_sequence", "slipwise.evaluation", "slipwise.export"),
    *("slipwise.inspection", "slipwise.models.upgrade", "slipwise.planning", "slipwise.reporting"),
)
WHOLE = ("slipwise.cli", "slipwise.logs")  # packages all of whose modules are loaded


@dataclass(frozen=True)
class Ended:
    """How a process ended; a negative code is the signal that ended it, SIGALRM where time was over."""

    code: int
    out: str
    err: str


@cache
def _warm() -> subprocess.Popen[str]:
    """Start the process that the others are forks of; it ends with this one, which holds its input."""
    return subprocess.Popen(
        [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def run_forked(
    arguments: Iterable[object],
    folder: Path,
    *,
    seconds: int,
    memory: int = 0,
    environment: Mapping[str, str] | None = None,
) -> Ended:
    """Run a command line in a folder, within some time [s] and, unless 0, some address space [bytes]."""
    warm = _warm()
    assert warm.stdin is not None
    assert warm.stdout is not None
    with tempfile.TemporaryDirectory() as said:
        out, err = Path(said, "out"), Path(said, "err")
        request = {
            "arguments": [str(each) for each in arguments],
            "folder": str(folder),
            "seconds": seconds,
            "memory": memory,
            "environment": dict(environment or {}),
            "out": str(out),
            "err": str(err),
        }
        warm.stdin.write(json.dumps(request) + "\n")
        warm.stdin.flush()
        code = int(warm.stdout.readline())
        return Ended(code, *(path.read_text("utf-8", errors="surrogateescape") for path in (out, err)))


def _child(request: dict[str, object]) -> None:
    """Become the command."""
    from slipwise.cli.main import main

    signal.alarm(int(str(request["seconds"])))
    os.chdir(str(request["folder"]))
    os.environ.update(request["environment"])  # type: ignore[call-overload]
    for number, name in ((0, os.devnull), (1, request["out"]), (2, request["err"])):
        opened = os.open(str(name), os.O_RDWR | os.O_CREAT, 0o600)
        os.dup2(opened, number)
    if memory := int(str(request["memory"])):
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    try:
        main([str(each) for each in request["arguments"]])  # type: ignore[attr-defined]
    except SystemExit as left:
        sys.stdout.flush()
        os._exit(int(str(left.code)))
    except BaseException:
        traceback.print_exc()
    os._exit(70)


def _modules_in(package: str) -> list[str]:
    folders = importlib.import_module(package).__path__
    return [each.name for each in pkgutil.iter_modules(folders, f"{package}.")]


def _serve() -> None:
    for module in (*LOADED, *(name for package in WHOLE for name in _modules_in(package))):
        importlib.import_module(module)
    gc.freeze()  # else a child that collects copies all of it
    for line in sys.stdin:
        pid = os.fork()
        if pid == 0:
            _child(json.loads(line))
        _, status = os.waitpid(pid, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)


if __name__ == "__main__":
    _serve()

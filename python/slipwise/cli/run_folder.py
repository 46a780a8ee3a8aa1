# SPDX-License-Identifier: Apache-2.0
"""The time-stamped folder of one run, marked until it is complete, and a `latest` link beside it."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.files import output_errors, write_text_whole
from slipwise.part_folder import is_locked, locked
from slipwise.stop_signals import held

if TYPE_CHECKING:
    from slipwise.calibration import Settings

LATEST = "latest"
INCOMPLETE = "INCOMPLETE"  # a file in the folder of a run that goes on, or was killed


@contextlib.contextmanager
def run_folder(runs: Path, command: str) -> Iterator[Path]:
    """Create `runs/<UTC time>-<command>`; at the end point `runs/latest` to it, or remove it after a failure.

    Until the end the folder holds a file INCOMPLETE, which stays where the process is killed.

    Raises:
        OutputError: the folder cannot be created.
    """
    folder: Path | None = None
    try:
        with held():  # else a folder may be created and then forgotten
            folder = _create(runs, command)
        with contextlib.ExitStack() as marked:
            mark = folder / INCOMPLETE
            with output_errors(mark):
                marked.enter_context(locked(mark))
            yield folder
            with output_errors(runs / LATEST):
                mark.unlink()
                _link(runs / LATEST, folder)
    except BaseException:
        with held():
            if folder is not None:
                shutil.rmtree(folder, ignore_errors=True)
            with contextlib.suppress(OSError):
                runs.rmdir()  # only if this run was the first and left it empty
        raise


def killed_runs(runs: Path) -> list[Path]:
    """Return the run folders whose process ended before they were complete, the oldest first."""
    return sorted(mark.parent for mark in runs.glob(f"*/{INCOMPLETE}") if not is_locked(mark))


def write_settings(folder: Path, settings: Settings) -> Path:
    """Write the settings as TOML that `--settings` takes again; return the path.

    Raises:
        OutputError: the file cannot be written.
    """
    from slipwise.calibration.settings import users_dump

    path = folder / "settings.toml"
    write_text_whole(path, to_toml(users_dump(settings)))
    return path


def to_toml(content: Mapping[str, Any]) -> str:
    """Return tables of plain values as TOML: single values first, then one section for each table."""
    lines = [f"{key} = {_toml(value)}" for key, value in content.items() if not isinstance(value, dict)]
    for name, table in content.items():
        if isinstance(table, dict):
            lines += ["", f"[{name}]", *(f"{key} = {_toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    return json.dumps(value)


def _create(runs: Path, command: str) -> Path:
    stamp = f"{datetime.now(UTC):%Y%m%dT%H%M%SZ}-{command}"
    number = 1
    while True:
        folder = runs / (stamp if number == 1 else f"{stamp}-{number}")
        with output_errors(folder):
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                if not runs.is_dir():
                    raise NotADirectoryError(20, os.strerror(20)) from None
                number += 1
                continue
        return folder


def _link(link: Path, folder: Path) -> None:
    """Replace the link in one step; something else of that name, of the user's, stays as it is."""
    if link.exists() and not link.is_symlink():
        return
    temporary = folder / f".{LATEST}"
    temporary.symlink_to(folder.name)
    temporary.replace(link)

# SPDX-License-Identifier: Apache-2.0
"""Names runs that have no name of their own."""

from __future__ import annotations

from pathlib import Path


def run_name(path: Path) -> str:
    """Return the name of a run that has none: the file's, without its endings."""
    name = path.name
    for ending in (".gz", ".csv", ".parquet", ".mcap", ".db3", ".bag", ".bin", ".tlog", ".ulg"):
        name = name.removesuffix(ending)
    return name or "run"

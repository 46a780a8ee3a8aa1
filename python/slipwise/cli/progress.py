# SPDX-License-Identifier: Apache-2.0
"""A progress bar on stderr, shown only to people at a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

Update = Callable[[str, float], None]


@contextlib.contextmanager
def progress_bar(first: str) -> Iterator[Update]:
    """Yield a function that is called with the current step and the fraction done, 0 to 1."""
    if not sys.stderr.isatty():
        yield lambda _what, _share: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(first, total=1.0)
        yield lambda what, fraction: progress.update(task, description=what, completed=fraction)

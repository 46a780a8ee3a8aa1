# SPDX-License-Identifier: Apache-2.0
"""Writes the keys in docs/settings.md from where they are declared: the tables of settings, and `log_fields`.

Run it as `python docs/settings_page.py` after a change of a key; a test compares.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from slipwise.calibration.keys import Key, keys_of
from slipwise.calibration.settings import Settings

PAGE = Path(__file__).with_name("settings.md")
_COLUMN = 29  # where comments start


def rows() -> Iterator[str]:
    """Yield the lines of all keys, table by table."""
    for table, keys in groupby(keys_of(Settings), key=lambda each: each.table):
        if table:
            yield ""
            yield f"{f'[{table}]':<{_COLUMN - 1}} # {_about(table)}"
        yield from map(_row, keys)


def _about(table: str) -> str:
    model: Any = Settings
    for name in table.split("."):
        model = model.model_fields[name].annotation
    first: str = model.__doc__.strip().splitlines()[0].rstrip(".")
    return first[0].lower() + first[1:]


def _row(key: Key) -> str:
    none = key.default is None
    line = f"{'# ' if none else ''}{key.name} = {key.example if none else json.dumps(key.default)}"
    return f"{line:<{_COLUMN - 1}} # {key.help}"


def with_rows(page: str) -> str:
    """Return the page with the keys as they are declared."""
    fence = "```toml\n"
    start = page.index(fence) + len(fence)
    return page[:start] + "\n".join(rows()) + page[page.index("\n```", start) :]


if __name__ == "__main__":
    PAGE.write_text(with_rows(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

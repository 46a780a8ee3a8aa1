# SPDX-License-Identifier: Apache-2.0
"""Writes the rows of [log] in docs/settings.md from where the options of reading a log are declared.

Run it as `python docs/settings_page.py` after a change of slipwise/log_fields.py; a test compares.
"""

from __future__ import annotations

import json
from pathlib import Path

from slipwise.log_fields import LOG_FIELDS, About

PAGE = Path(__file__).with_name("settings.md")
_COLUMN = 29  # where comments start
_HEAD = "[log]"
_ABOUT = "how a log is read (--help-log); the command line goes before; several are a list"
_UNITS = {"METRES": "m: ", "SECONDS": "s: ", "RADIANS": "rad: ", "MIB": "MiB: "}


def _row(about: About) -> str:
    value = json.dumps(about.default) if about.default is not None else about.example
    if about.default == {}:
        value = "{}"
    key = f"{'# ' if about.default is None else ''}{about.name} = {value}"
    return f"{key:<{_COLUMN - 1}} # {_UNITS.get(about.metavar, '')}{about.help}"


def with_rows(page: str) -> str:
    """Return the page with the rows of [log] as they are declared."""
    rows = [f"{_HEAD:<{_COLUMN - 1}} # {_ABOUT}", *map(_row, LOG_FIELDS)]
    start = page.index(f"\n{_HEAD}") + 1
    end = page.index("\n\n", start)
    return page[:start] + "\n".join(rows) + page[end:]


if __name__ == "__main__":
    PAGE.write_text(with_rows(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

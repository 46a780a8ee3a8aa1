# SPDX-License-Identifier: Apache-2.0
"""Writes the table of findings in docs/troubleshooting.md from the checks that find them.

Run it as `python docs/findings_page.py` after a change of a check; a test compares.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from slipwise.logs.findings.checks import EVERY
from slipwise.logs.findings.finding import FAMILIES

PAGE = Path(__file__).with_name("troubleshooting.md")
_BEGIN, _END = "| it finds | what is wrong | what shows it | what to change |\n|---|---|---|---|\n", "\n\n"


def rows() -> Iterator[str]:
    """Yield a row for each check, family by family."""
    for family in FAMILIES:
        for check in EVERY:
            if check.family == family:
                yield f"| {family}: `{check.kind}` | {check.means} | {check.shows} | {check.cure} |"


def with_rows(page: str) -> str:
    """Return the page with the findings as they are declared."""
    start = page.index(_BEGIN) + len(_BEGIN)
    return page[:start] + "\n".join(rows()) + page[page.index(_END, start) :]


if __name__ == "__main__":
    PAGE.write_text(with_rows(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

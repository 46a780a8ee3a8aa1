# SPDX-License-Identifier: Apache-2.0
"""What a section of the report is; anyone can write one and pass it to `write_report`."""

from __future__ import annotations

from typing import Protocol

from slipwise.reporting.contents import Contents


class Section(Protocol):
    """One heading of the report with what stands below it.

    A section shows nothing it does not have: where data are missing, its html is a sentence that says so
    (`markup.missing`). Text that came from a user goes through `markup.escape`; pictures are a `Figure`.
    """

    title: str  # says what one sees
    explanation: str  # one plain sentence, below the title

    def html(self, contents: Contents) -> str:
        """Return the HTML below title and explanation."""
        ...

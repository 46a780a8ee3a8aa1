# SPDX-License-Identifier: Apache-2.0
"""What was in the files and was not used, why, and what was guessed."""

from __future__ import annotations

from slipwise.reporting.contents import Contents
from slipwise.reporting.markup import bullets, paragraph, table


class LeftOutSection:
    """What is not in the figures above?"""

    title = "Data left out, and what was guessed"
    explanation = "What the files hold and was not used, with the first place, and every assumption."

    def html(self, contents: Contents) -> str:
        """Return the table of what was left out and the notes."""
        stages = (
            ("reading the log", contents.log),
            ("learning", contents.calibration),
            ("scoring", contents.evaluation),
        )
        # Later stages hand on what earlier ones left out: each entry is shown once, where it first appears.
        seen = set()
        rows = []
        for stage, result in stages:
            for entry in result.left_out:
                if entry not in seen:
                    seen.add(entry)
                    rows.append((entry.kind, str(entry.count), entry.where, entry.reason, stage))
        head = ("what", "count", "first place", "why", "while")
        html = table(head, rows, kind="listing") if rows else paragraph("Nothing was left out.")
        notes = list(dict.fromkeys(note for _, result in stages for note in result.notes))
        return html + (
            paragraph("Guessed or worked out:") + bullets(notes)
            if notes
            else paragraph("Nothing was guessed.")
        )

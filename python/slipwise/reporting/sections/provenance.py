# SPDX-License-Identifier: Apache-2.0
"""Where the results come from: version, logs with their hashes, settings, command line, model file."""

from __future__ import annotations

import json
from collections.abc import Sequence

from slipwise.number_text import DASH
from slipwise.reporting.contents import Contents
from slipwise.reporting.markup import details, escape, paragraph, table


class ProvenanceSection:
    """How can these results be made again?"""

    title = "How to make this again"
    explanation = "The same log, settings and version give the same bytes, on the same machine and build."

    def html(self, contents: Contents) -> str:
        """Return the facts, the logs, the settings and the model file."""
        model = contents.calibration.model
        provenance = model.content.provenance
        facts = [
            ("slipwise version", provenance.slipwise_version),
            ("command line", contents.command or "not recorded"),
            ("input", model.content.input),
            ("slip basis", model.content.slip.basis),
            (
                "learned from",
                f"{provenance.learned_seconds:.1f} s of driving, {provenance.learned_segments} windows",
            ),
            ("scored methods", ", ".join(contents.evaluation.methods) or DASH),
        ]
        settings = json.dumps(provenance.settings, indent=2, sort_keys=True, ensure_ascii=False, default=str)
        return (
            _listed(facts)
            + _logs(contents)
            + details("Settings", f"<pre>{escape(settings)}</pre>")
            + details("Model file", f"<pre>{escape(model.to_yaml())}</pre>")
        )


def _listed(facts: Sequence[tuple[str, str]]) -> str:
    rows = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in facts)
    return f'<dl class="facts">{rows}</dl>'


def _logs(contents: Contents) -> str:
    read = [(source.path, source.format, str(source.rows), source.sha256) for source in contents.log.sources]
    hashes = {row[3] for row in read}
    learned = [
        (log.path, "learned from", "", log.sha256)
        for log in contents.calibration.model.content.provenance.logs
        if log.sha256 not in hashes
    ]
    if not read and not learned:
        return paragraph("The log was not read from a file.")
    return table(("log", "format", "rows or messages", "SHA-256"), [*read, *learned], kind="hashes")

# SPDX-License-Identifier: Apache-2.0
"""Where an exported file comes from: version, model, logs, verdict and range, as lines of a comment."""

from __future__ import annotations

import hashlib
import re
from importlib.metadata import version

from slipwise.models.model import Model

_WIDTH = (
    400  # characters of one line at most; paths and sentences come from a file that anyone may have written
)


def origin_lines(model: Model, name: str) -> list[str]:
    """Return the lines that say what a file was made of.

    Args:
        model: the exported model.
        name: of the model's file.
    """
    content = model.content
    learned, verdict, span = content.provenance, content.verdict, content.range
    digest = hashlib.sha256(model.to_yaml().encode()).hexdigest()
    logs = [f"log: {log.path} (sha256 {log.sha256[:16]})" for log in learned.logs] or ["log: none named"]
    guessed = [p.name for p in content.parameters if not p.identifiable]
    lines = [
        (
            f"slipwise {version('slipwise')}, model {name} (sha256 {digest[:16]}),"
            f" learned by slipwise {learned.slipwise_version}"
        ),
        *logs,
        f"learned from {learned.learned_seconds:.0f} s of {content.input}s, basis {content.slip.basis}",
        f"verdict: {'good' if verdict.good else 'NOT GOOD ENOUGH'}. {verdict.sentence}",
        (
            f"known to hold for speeds {span.speed[0]:.3g} to {span.speed[1]:.3g} m/s"
            f" and yaw rates {span.yaw_rate[0]:.3g} to {span.yaw_rate[1]:.3g} rad/s"
        ),
    ]
    if guessed:
        lines.append(f"not identifiable from the log, so about as guessed before it: {', '.join(guessed)}")
    return [one_line(line) for line in lines]


def one_line(text: str) -> str:
    """Return the text without anything that could end a comment, in YAML or in C."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    for mark in ("*/", "/*"):
        plain = plain.replace(mark, " ".join(mark))
    plain = re.sub(r"\?(?=\?)", "? ", plain)  # of three marks, too, no two stay together
    return " ".join(plain.split())[:_WIDTH]

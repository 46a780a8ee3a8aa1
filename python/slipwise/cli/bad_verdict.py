# SPDX-License-Identifier: Apache-2.0
"""Saying that nothing is written from a model with a bad verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.models import Model


def say_refused(out: Output, model: Model, command: str) -> None:
    """Report that `command` wrote nothing, and why."""
    from slipwise.cli.document import head

    verdict = model.content.verdict
    out.document(head(command) | {"exit_code": 1, "verdict": verdict.model_dump(), "files": {}})
    out.line(f"NOT GOOD ENOUGH. {verdict.sentence}")
    out.line("  Nothing was written. Learn from a better log, or use --force to write it all the same.")

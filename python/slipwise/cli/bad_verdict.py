# SPDX-License-Identifier: Apache-2.0
"""Saying that nothing is written from a model with a bad verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.models import Model


def without_bad_input(out: Output, model: Model, target: str) -> tuple[Model, Model | None]:
    """Return what may be exported of a model; also what is to be refused, where that is all.

    Args:
        out: where it is said that one input of two is left out.
        model: which may answer from two inputs, each with its verdict.
        target: a tool, or "all".
    """
    from slipwise.export.targets import find_target, for_target
    from slipwise.models.inputs import MANY

    parts = [model.of_input(name) for name in model.inputs]
    if target != "all":
        parts = [for_target(model, find_target(target))]
    good = [part for part in parts if part.verdict.good]
    if not good:
        return model, parts[0]
    if len(good) == len(parts):
        return model, None
    (bad,) = (part for part in parts if not part.verdict.good)
    name = MANY[bad.content.input]
    out.line(
        f"What was learned from {name} is left out, since it is not good enough: --force exports it too."
    )
    return good[0].alone, None


def say_refused(out: Output, model: Model, command: str) -> None:
    """Report that `command` wrote nothing, and why."""
    from slipwise.cli.document import head

    verdict = model.content.verdict
    out.document(head(command) | {"exit_code": 1, "verdict": verdict.model_dump(), "files": {}})
    out.line(f"NOT GOOD ENOUGH. {verdict.sentence}")
    out.line("  Nothing was written. Learn from a better log, or use --force to write it all the same.")

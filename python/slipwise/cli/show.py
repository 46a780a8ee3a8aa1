# SPDX-License-Identifier: Apache-2.0
"""`slipwise show`: what a model file says, in words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from slipwise.cli.options import Json, ModelFile, ModelInput

if TYPE_CHECKING:
    from slipwise.models import Model
    from slipwise.models.summary import Summary


def show(model: ModelFile, input_name: ModelInput = None, json: Json = None) -> int:
    """Say what a model has learned, how well it predicts, where it comes from and where it holds.

    Numbers stand in the sentences where they are identified; the table has all of them.

    \b
    Examples:
      slipwise show model.yaml
      slipwise show model.yaml --json - | jq '.parameters[] | select(.identified)'
    """  # noqa: D301
    from slipwise.cli.other_input import show_other_input
    from slipwise.cli.output import Output
    from slipwise.cli.tables import (
        show_parameters,
        show_shares,
        show_summary,
        show_surfaces,
        show_verdict,
    )
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import load_model
    from slipwise.models.summary import summarise

    out = Output(json)
    refuse_unwritable(out.written_file, inputs=[model])
    learned = load_model(model, input=input_name)
    summary = summarise(learned)
    out.document(_document(learned, summary))
    content = learned.content
    out.line(f"{model.name}: {content.slip.basis} learned from {content.input}s")
    show_summary(out, summary)
    show_verdict(out, content.verdict)
    for line in _origin(learned):
        out.line(line)
    show_other_input(out, learned, model)
    show_shares(out, learned)
    show_parameters(out, summary.parameters)
    if content.surfaces:
        show_surfaces(out, content.surfaces)
    return 0


def _origin(model: Model) -> tuple[str, ...]:
    """Where the model comes from, and where it holds."""
    from slipwise.number_text import span_text

    origin, span = model.content.provenance, model.content.range
    speed, yaw_rate = span_text(span.speed), span_text(span.yaw_rate)
    amount = f"{origin.learned_segments} segments, {origin.learned_seconds:.0f} s of driving"
    commands = [
        f"{name} {span_text(ends)}"
        for name in ("throttle", "steering")
        if (ends := getattr(span, name)) is not None
    ]
    driven = f" ({', '.join(commands)})" if commands else ""
    return (
        f"Learned by slipwise {origin.slipwise_version} from {amount}:",
        *(f"  {log.path}" for log in origin.logs),
        f"Holds from {speed} m/s and from {yaw_rate} rad/s{driven}, as far as the log went.",
    )


def _document(model: Model, summary: Summary) -> dict[str, Any]:
    from dataclasses import asdict

    from slipwise.cli.document import head, shares_part, surfaces_part
    from slipwise.cli.other_input import other_input_part

    content = model.content
    return head("show") | {
        "exit_code": 0,
        "input": content.input,
        "basis": content.slip.basis,
        "summary": list(summary.sentences),
        "parameters": [asdict(parameter) for parameter in summary.parameters],
        "verdict": content.verdict.model_dump(),
        "range": content.range.model_dump(),
        "shares": shares_part(model),
        "provenance": content.provenance.model_dump(),
        "surfaces": surfaces_part(model),
        **other_input_part(model),
    }

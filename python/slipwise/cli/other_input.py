# SPDX-License-Identifier: Apache-2.0
"""What a model says from its other input, below what it says from the one that it is meant for."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from slipwise.calibration import Calibration
    from slipwise.cli.output import Output
    from slipwise.models import Model


def show_other_input(out: Output, model: Model, path: Path) -> None:
    """Say what was learned from the other input, and how good that is; nothing where there is no other.

    What the model says from the first input is not said again.
    """
    from slipwise.cli.tables import show_verdict
    from slipwise.models.inputs import MANY
    from slipwise.models.summary import summarise

    for name in model.inputs[1:]:
        other = model.of_input(name)
        origin = other.content.provenance
        out.line(
            f"The same file answers from {MANY[name]} too: {origin.learned_segments} segments, "
            f"{origin.learned_seconds:.0f} s of driving; `slipwise show {quote(str(path))} --input {name}` "
            "has all numbers."
        )
        said = (*summarise(model).sentences, *model.verdict.advice)
        for sentence in summarise(other).sentences:
            if sentence not in said:
                out.line(f"  {sentence}")
        advice = [text for text in other.verdict.advice if text not in said]
        show_verdict(out, other.verdict.model_copy(update={"advice": advice}))


def other_input_part(model: Model, calibration: Calibration | None = None) -> dict[str, Any]:
    """Return the same for programs; empty where there is no other input.

    Args:
        model: which may have another input.
        calibration: of the model, where it was just learned.
    """
    from slipwise.cli.document import calibration_part
    from slipwise.models.summary import summarise

    if len(model.inputs) < 2:
        return {}
    other = model.of_input(model.inputs[1])
    if calibration is not None and calibration.other is not None:
        said = calibration_part(calibration.other)
    else:
        parameters = [parameter.model_dump() for parameter in other.content.parameters]
        said = {"input": other.content.input, "summary": list(summarise(other).sentences)} | {
            "parameters": parameters
        }
    return {"other_input": said | {"verdict": other.verdict.model_dump()}}

# SPDX-License-Identifier: Apache-2.0
"""What a notebook shows of a model: the summary, the verdict, and the parameters in physical units."""

from __future__ import annotations

from html import escape

from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter
from slipwise.models.summary import summarise
from slipwise.number_text import estimate_texts

_HEAD = ("parameter", "value", "std", "unit", "identified")


def model_html(model: Model) -> str:
    """Return a fragment of HTML; every text in it is escaped."""
    content, summary = model.content, summarise(model)
    head = f"<b>{escape(content.slip.basis)}</b> learned from {escape(content.input)}s"
    sentences = "".join(f"<li>{escape(sentence)}</li>" for sentence in summary.sentences)
    state = "Good." if content.verdict.good else "Not good enough."
    verdict = f"<p><b>{state}</b> {escape(content.verdict.sentence)}</p>"
    return f"<div><p>{head}</p><ul>{sentences}</ul>{verdict}{_table(summary.parameters)}</div>"


def _table(parameters: tuple[PhysicalParameter, ...]) -> str:
    head = "".join(f"<th>{name}</th>" for name in _HEAD)
    rows = "".join(_row(parameter) for parameter in parameters)
    count = f"{len(parameters)} parameters" if len(parameters) != 1 else "1 parameter"
    return (
        f"<details><summary>{count}</summary><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{rows}</tbody></table></details>"
    )


def _row(parameter: PhysicalParameter) -> str:
    value, std = estimate_texts(parameter.value, parameter.std)
    cells = (parameter.name, value, std, parameter.unit, "yes" if parameter.identified else "no")
    return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"

# SPDX-License-Identifier: Apache-2.0
"""`slipwise compare`: whether a new model predicts a log better than an old one, and what differs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import Json, ModelInput, takes_log_options

if TYPE_CHECKING:
    from collections.abc import Sequence

    from slipwise.cli.output import Output
    from slipwise.evaluation import Evaluation
    from slipwise.evaluation.compare_models import ModelComparison
    from slipwise.evaluation.head_to_head import HeadToHead
    from slipwise.logs import LogOptions
    from slipwise.models import Model
    from slipwise.models.difference import Difference

_MOST_NAMED = 5  # numbers that a sentence names


@takes_log_options
def compare(
    first: Annotated[Path, typer.Argument(metavar="OLD.yaml", show_default=False, help="A model file.")],
    second: Annotated[Path, typer.Argument(metavar="NEW.yaml", show_default=False, help="Another one.")],
    log_options: LogOptions,
    logs: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[LOG...]", show_default=False, help="Logs to predict with both."),
    ] = None,
    input_name: ModelInput = None,
    json: Json = None,
) -> int:
    """Say whether a new model predicts a log better than an old one, and what differs between them.

    Give a log that neither has learned from; several count as one. Both models predict all its segments as
    they are, and one is better where the 95 % interval of its errors relative to the other's says so. Numbers
    differ where they lie three standard deviations of both together apart.

    \b
    Examples:
      slipwise compare monday.yaml tuesday.yaml
      slipwise compare grass.yaml asphalt.yaml wednesday.mcap
    """  # noqa: D301
    from slipwise.cli.model_names import named_models
    from slipwise.cli.output import Output
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models.body_force import without_force
    from slipwise.models.common_input import of_common_input
    from slipwise.models.difference import differences
    from slipwise.models.inputs import MANY

    out = Output(json)
    refuse_unwritable(out.written_file, inputs=(first, second, *(logs or []), *log_options.files))
    named = named_models([first, second])
    if input_name is None:
        models = of_common_input(named)
    else:
        models = {name: model.of_input(input_name) for name, model in named.items()}
    slips = {name: without_force(model) for name, model in models.items()}  # a force is of its day
    rows = differences(*slips.values())
    comparison = _compared(models, logs, log_options) if logs else None
    out.document(_document(slips, rows, comparison))
    if comparison is not None:
        _show_comparison(out, comparison)
    _show_differences(out, slips, rows)
    if all(len(model.inputs) > 1 for model in named.values()) and input_name is None:
        used, other = next(iter(named.values())).inputs
        out.line(f"Compared from {MANY[used]}; both models answer from {MANY[other]} too: --input {other}.")
    return 0


def _compared(models: dict[str, Model], logs: Sequence[Path], options: LogOptions) -> ModelComparison:
    from slipwise.cli.progress import progress_bar
    from slipwise.evaluation.compare_models import compare_models
    from slipwise.logs import open_log

    with progress_bar("reading") as update:
        old, new = models.items()
        return compare_models(
            old,
            new,
            open_log(*logs, options=options),
            progress=lambda name, fraction: update(f"method {name}", fraction),
        )


def _document(
    models: dict[str, Model], rows: Sequence[Difference], comparison: ModelComparison | None
) -> dict[str, Any]:
    from slipwise.cli.document import evaluation_part, head
    from slipwise.models.difference import same_logs, same_terms

    document = head("compare") | {
        "exit_code": 0,
        "models": list(models),
        "same_logs": same_logs(*models.values()),
        "same_terms": same_terms(*models.values()),
        "differences": [asdict(row) | {"z": row.z, "different": row.different} for row in rows],
    }
    if comparison is None:
        return document
    of_all, *each = ({**asdict(m), "better": m.better} for m in (comparison.decisive, *comparison.matches))
    said = {
        "sentences": comparison.sentences(),
        "learned_from_this": comparison.learned_from_this,
        "horizons": each,
    }
    return document | {"predictions": of_all | said} | evaluation_part(comparison.evaluation)


def _show_differences(out: Output, models: dict[str, Model], rows: Sequence[Difference]) -> None:
    from slipwise.cli.output import Column
    from slipwise.models.difference import DIFFERENT, same_drive, same_logs, same_terms

    both = [row for row in rows if row.first is not None and row.second is not None]
    different = [row for row in both if row.different]
    agree = (
        f"{len(both) - len(different)} of {len(both)} numbers agree within {DIFFERENT:g} standard deviations"
    )
    out.line(f"{agree}." if different else f"Nothing differs: {agree}.")
    different.sort(key=lambda row: -abs(row.z))
    if different:
        out.line(different_sentence(different))
    shown = different + [row for row in rows if row not in both]
    cells = [(row.name, _cell(row.first), _cell(row.second), row.unit, _z_text(row.z)) for row in shown]
    if cells:
        heads = [Column("number", whole=True), *(Column(name, True) for name in models)]
        title = "What differs" if different else "What one of them has alone"
        out.table(title, (*heads, Column("unit"), Column("z", True, whole=True)), cells)
    if not same_drive(*models.values()):
        out.line("The models describe the drive otherwise: only what it does in all and limits are compared.")
    elif not same_terms(*models.values()):
        out.line("The models have different slip terms: only gains, times and limits are compared.")
    if same_logs(*models.values()):
        out.line(
            "Both have learned from the same log: their errors are alike, and z is smaller than it says."
        )


def different_sentence(different: Sequence[Difference]) -> str:
    """Say which numbers differ and by how many standard deviations, the farthest first."""
    named = [f"{row.name} by {abs(row.z):.1f}" for row in different[:_MOST_NAMED]]
    more = len(different) - len(named)
    rest = f" and {more} more" if more else ""
    return f"Different, in standard deviations of both together: {', '.join(named)}{rest}."


def _show_comparison(out: Output, comparison: ModelComparison) -> None:
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_left_out, show_notes

    for sentence in comparison.sentences():
        out.line(sentence)
    names = (comparison.old, comparison.new)
    heads = [Column("after", True, whole=True), Column("segments", True)]
    for error in ("position [m]", "heading [rad]"):
        heads += [*(Column(f"{error} {name}", True) for name in names), Column("new/old", True, whole=True)]
    out.table("Mean errors", heads, [_match_row(match) for match in comparison.matches])
    show_notes(out, comparison.evaluation.notes)
    show_left_out(out, comparison.evaluation.left_out)


def _match_row(match: HeadToHead) -> tuple[str, ...]:
    from slipwise.number_text import number_text

    cells = [f"{match.horizon:g} s", str(match.windows)]
    for means, ratio in ((match.mean_position, match.position), (match.mean_heading, match.heading)):
        cells += [*map(number_text, means), _ratio(ratio)]
    return tuple(cells)


def comparison_sentences(evaluation: Evaluation) -> list[str]:
    """Say for each further model file whether it predicts better than the first."""
    from slipwise.evaluation.head_to_head import head_to_head

    first, *others = evaluation.models
    sentences = [_sentence(head_to_head(evaluation, first, other)) for other in others]
    seen = [name for name in evaluation.models if not evaluation.score(name, max(evaluation.horizons)).causal]
    if seen:
        sentences.append(f"{' and '.join(seen)} learned from this very log: compare on another drive.")
    return sentences


def _sentence(match: HeadToHead) -> str:
    winner = "Neither predicts clearly better" if match.better is None else f"{match.better} predicts better"
    return (
        f"{winner}: after {match.horizon:g} s {match.second} misses by {_ratio(match.position)} times what "
        f"{match.first} does in position, and {_ratio(match.heading)} times in heading "
        f"({match.windows} held-out segments, 95 % intervals)."
    )


def _ratio(ratio: tuple[float, float, float]) -> str:
    from slipwise.number_text import number_text

    value, low, high = (number_text(part, 2) for part in ratio)
    return f"{value} ({low} to {high})"


def _cell(estimate: tuple[float, float] | None) -> str:
    from slipwise.number_text import DASH, estimate_text

    return DASH if estimate is None else estimate_text(*estimate)


def _z_text(z: float) -> str:
    import math

    from slipwise.number_text import DASH

    return f"{z:+.1f}" if math.isfinite(z) else DASH if math.isnan(z) else f"{z:+}"

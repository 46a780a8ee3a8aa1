# SPDX-License-Identifier: Apache-2.0
"""`slipwise evaluate --memory`: drives of one robot in their order, and the surfaces that it remembers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.cli.output import Column, Output

if TYPE_CHECKING:
    from slipwise.calibration import Settings
    from slipwise.calibration.learned_sequence import SequenceOptions
    from slipwise.evaluation import EvaluationOptions, SequenceEvaluation
    from slipwise.logs import Log, LogOptions

EVEN = 0.01  # of an error; so small a difference is none


@dataclass(frozen=True)
class MemoryQuestion:
    """What is asked of a sequence of logs."""

    logs: Sequence[Path]
    log_options: LogOptions
    input: str | None
    options: EvaluationOptions
    begin: SequenceOptions  # prior and labels
    predictions: Path | None  # file to write
    report: Path | None = None


def evaluate_memory(out: Output, asked: MemoryQuestion, settings: Settings, runs: Path) -> int:
    """Evaluate logs one after the other with what is remembered of surfaces; 0 where that beats the baseline.

    With `report` it writes a page too.
    """
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.run_folder import run_folder, write_settings
    from slipwise.evaluation import evaluate_sequence, write_sequence
    from slipwise.files import write_text_whole
    from slipwise.logs import open_log

    with progress_bar("reading") as update, run_folder(runs, "evaluate") as folder:
        logs = [(path.name, open_log(path, options=asked.log_options)) for path in asked.logs]
        sequence = evaluate_sequence(
            logs,
            input=asked.input,
            settings=settings,
            options=replace(asked.options, memory=asked.begin),
            progress=update,
        )
        files = {"settings": write_settings(folder, settings)}
        if asked.predictions is not None:
            write_sequence(asked.predictions, sequence.evaluations)
            files["predictions"] = asked.predictions
        if asked.report is not None:
            files["report"] = _write_page(asked.report, [log for _, log in logs], sequence)
        from slipwise.cli.output import to_json

        document = _document(sequence, files)
        write_text_whole(folder / "result.json", to_json(document))
        out.document(document)
    _show(out, sequence)
    from slipwise.cli.tables import show_files

    show_files(out, files | {"run folder": folder})
    return 0 if sequence.good else 1


def _write_page(path: Path, logs: list[Log], sequence: SequenceEvaluation) -> Path:
    from slipwise.cli.command_line import command_line
    from slipwise.reporting.sequence_page import write_sequence_page

    title = f"{len(logs)} drives in turn"
    return write_sequence_page(path, logs, sequence, title=title, command=command_line())


def _show(out: Output, sequence: SequenceEvaluation) -> None:
    from slipwise.cli.evaluation_verdict import LEARNED_FROM_THIS
    from slipwise.cli.tables import NOT_CAUSAL, marked, show_memory_changes, show_surfaces

    going_on = bool(sequence.went_on)
    columns = (
        "windows",
        "m, rad",
        "first ten",
        *(("going on", "first ten ") if going_on else ()),
        "baseline",
    )
    rows = [
        (
            marked(visit.log, causal=causal),
            visit.surface,
            f"{visit.windows}",
            _pair(visit.position, visit.heading),
            _pair(visit.first_position, visit.first_heading),
            *((_pair(visit.going_on_position, visit.going_on_heading),) if going_on else ()),
            *((_pair(visit.going_on_first_position, visit.going_on_first_heading),) if going_on else ()),
            _pair(visit.baseline_position, visit.baseline_heading),
        )
        for visit, causal in zip(sequence.visits(), sequence.causal, strict=True)
    ]
    out.table(
        "Mean errors of position and heading with a memory of surfaces",
        (Column("log"), Column("surface"), *(Column(name, True) for name in columns)),
        rows,
    )
    if not all(sequence.causal):
        out.line(NOT_CAUSAL)
    for name, causal in zip(sequence.names, sequence.causal, strict=True):
        if not causal:
            out.line(f"{name}: {LEARNED_FROM_THIS}")
    if sequence.gain is not None:
        out.line(of_the_memory(*sequence.gain))
    show_surfaces(out, sequence.learned.surfaces)
    show_memory_changes(out, sequence.names, sequence.learned)


def _pair(position: float, heading: float) -> str:
    return f"{position:.3f} {heading:.3f}"


def of_the_memory(position: float, heading: float) -> str:
    """Say whether the memory pays, against one learner that goes on from log to log."""
    low, high = sorted((position, heading))
    if low > 1.0 - EVEN and high < 1.0 + EVEN:
        worth = "no difference; leave --memory out, unless you need the names of surfaces"
    elif high < 1.0 + EVEN:
        worth = "the memory pays"
    elif low > 1.0 - EVEN:
        worth = "leave --memory out, unless you need the names of surfaces"
    else:
        worth = "better at the one, worse at the other"
    return (
        f"With the memory {position:.2f} of the position and {heading:.2f} of the heading error of one "
        f"learner that goes on without: {worth}."
    )


def _document(sequence: SequenceEvaluation, files: dict[str, Path]) -> dict[str, Any]:
    from slipwise.cli.document import evaluation_part, head, memory_part

    visited = zip(sequence.names, sequence.evaluations, sequence.learned.logs, sequence.visits(), strict=True)
    return head("evaluate") | {
        "exit_code": 0 if sequence.good else 1,
        "files": files,
        "logs": [
            {"log": name, "surface": log.surface, "changes": [asdict(change) for change in log.changes]}
            | {"visit": asdict(visit)}
            | evaluation_part(evaluation)
            for name, evaluation, log, visit in visited
        ],
        **memory_part(sequence.learned),
    }

# SPDX-License-Identifier: Apache-2.0
"""`slipwise inspect`: what is in a log, and what could be learned from it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import (
    Basis,
    Changes,
    Json,
    Logs,
    SettingsFile,
    chosen_settings,
    optional,
    takes_log_options,
)
from slipwise.errors import SettingsError
from slipwise.number_text import count_text, number_text

if TYPE_CHECKING:
    from slipwise.calibration import Settings
    from slipwise.cli.output import Output
    from slipwise.excitation import Excitation
    from slipwise.inspection import Inspection, Learnability, Stream, Timing
    from slipwise.logs import LogOptions, Survey


@takes_log_options
def inspect(
    logs: Logs,
    log_options: LogOptions,
    basis: Basis = None,
    settings: SettingsFile = None,
    changes: Changes = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Check that a shared log keeps to the standard format.")
    ] = False,
    excite: Annotated[
        Path | None,
        optional("FILE.csv", "Write the drive that teaches most after this log, in place of advice."),
    ] = None,
    excite_area: Annotated[
        str | None, optional("WxD", "Its free ground: metres along, and across (8x8 where not given).")
    ] = None,
    json: Json = None,
) -> int:
    """Say what is in one or several logs and what could be learned from them.

    Shows every topic or column and what it is used as, streams with rates and gaps, what had to be left out,
    how late the poses are, which speeds and yaw rates were driven, and which parameters the log determines. A
    log that can be read is never an error here: what is missing or unclear is said, with the option to add.
    With --strict, one Parquet file is checked against the format of shared logs, with its schema file and
    data card; the exit code is 1 where something departs from it. With --excite, held commands go into
    a file: what teaches most of what this log leaves open, no faster than it was driven.

    \b
    Examples:
      slipwise inspect drive.mcap
      slipwise inspect drive.bag --pose-topic /rtk/odom --wheel-topic /husky/odom
      slipwise inspect drive.csv --json - | jq .streams
      slipwise inspect drive.csv --excite next.csv --excite-area 10x6
      slipwise inspect shared.parquet --strict
    """  # noqa: D301
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.inspection import inspect_files

    out = Output(json)
    chosen = chosen_settings(settings, changes, basis)
    _refuse_unused(excite, excite_area, strict=strict)
    area = excite_area or "8x8"
    refuse_unwritable(out.written_file, excite, inputs=(*logs, *log_options.files, settings))
    if strict:
        return _check_strictly(out, logs)
    with progress_bar("reading") as update:
        inspection = inspect_files(logs, log_options, chosen, progress=update, keep=excite is not None)
        drive = None
        if excite is not None and not inspection.problem:
            from slipwise.cli.numbers import area_of

            drive = _write_drive(excite, inspection, area_of(area, "--excite-area"), chosen, update)
    document = _document(inspection)
    if drive is not None:
        document |= {"excite": {"file": excite, "seconds": drive.seconds, "start": drive.start}}
    code = int(excite is not None and drive is None) * 2
    out.document(document | {"exit_code": code})
    _show(out, inspection, advise=drive is None)
    if code:
        out.line(f"{excite} is not written: what is to be learned next follows from what can be learned.")
    if drive is not None:
        out.line(
            f"{excite}: {drive.seconds:.0f} s of held commands that teach most of what is open, no faster"
        )
        out.line(f"  than this log, inside {area} m; a person plays them, with the stop button in hand")
    return code


def _refuse_unused(excite: Path | None, area: str | None, *, strict: bool) -> None:
    if excite is None and area is not None:
        raise SettingsError("no drive is asked for", where="--excite-area", advice="give --excite too")
    if excite is not None and strict:
        raise SettingsError("a format is checked alone", where="--strict", advice="leave --excite away")


def _write_drive(
    path: Path,
    inspection: Inspection,
    area: tuple[float, float],
    settings: Settings,
    update: Callable[[str, float], None],
) -> Excitation:
    from slipwise.excitation import ExcitationOptions, write_commands
    from slipwise.inspection import next_drive

    drive = next_drive(
        inspection.log,
        ExcitationOptions(area=area),
        settings,
        progress=lambda part: update("searching a drive", part),
        kept=inspection.kept,
    )
    write_commands(path, drive)
    return drive


def _check_strictly(out: Output, logs: Sequence[Path]) -> int:
    """Show all that departs from the format of shared logs."""
    from dataclasses import asdict

    from slipwise.cli.document import head
    from slipwise.cli.output import Column
    from slipwise.inspection import check_strictly

    if len(logs) != 1:
        raise SettingsError(
            "one file at a time", where="--strict", advice="run it once for each Parquet file"
        )
    found = check_strictly(logs[0])
    code = 1 if found else 0
    out.document(head("inspect") | {"exit_code": code, "departures": [asdict(each) for each in found]})
    if found:
        columns = [Column("kind", whole=True), Column("what"), Column("where")]
        out.table("Departures from the format", columns, [(e.kind, e.what, e.where) for e in found])
    out.line(f"{logs[0]}: {f'{len(found)} departures' if found else 'keeps to the format of shared logs'}")
    return code


def _document(inspection: Inspection) -> dict[str, object]:
    from dataclasses import asdict

    from slipwise.cli.document import head, log_part

    log = inspection.log
    learnable = [
        {name: value for name, value in asdict(item).items() if name != "parameters"}
        | {"parameters": [asdict(p) | {"identifiable": p.identifiable} for p in item.parameters]}
        for item in inspection.learned
    ]
    return (
        head("inspect")
        | {"exit_code": 0, "runs": [run.name for run in log.runs], "problem": inspection.problem}
        | {"files": [asdict(survey) for survey in inspection.surveys]}
        | {"streams": [asdict(stream) for stream in inspection.streams]}
        | {"timing": [asdict(timing) for timing in inspection.timing]}
        | {"learnable": learnable, "maps": inspection.maps}
        | {"findings": [asdict(found) for found in inspection.found]}
        | log_part(log, log.left_out)
    )


def _show(out: Output, inspection: Inspection, *, advise: bool) -> None:
    from slipwise.cli.doctor import show_findings
    from slipwise.cli.tables import show_left_out, show_notes

    log = inspection.log
    for survey in inspection.surveys:
        _show_survey(out, survey)
    if inspection.problem:
        out.line(f"Nothing can be learned from this yet: {inspection.problem}")
        return
    show_notes(out, log.notes)
    _show_streams(out, inspection.streams)
    show_left_out(out, log.left_out)
    if inspection.timing:
        _show_timing(out, inspection.timing)
    for name, lines in inspection.maps.items():
        out.line(f"Driven by {name}s")
        for line in lines:
            out.line(f"  {line}")
        out.line()
    if inspection.found:
        out.line(f"Wrong in this log: {count_text(len(inspection.found), 'finding')}")
        show_findings(out, inspection.found)
    for item in inspection.learned:
        _show_learnability(out, item, advise=advise)


_MANY = {"command": "commands", "wheel": "wheel speeds", "pose": "poses"}


def _show_survey(out: Output, survey: Survey) -> None:
    """Show every topic or column; the reasons stand below, where they are not cut into pieces."""
    from slipwise.cli.output import Column

    rows: list[tuple[str, ...]]
    if all(part.type == "column" for part in survey.parts):
        columns = [Column("column", whole=True), Column("cells", True), Column("used as")]
        rows = [(p.name, str(p.count), p.used_as or "-") for p in survey.parts]
    else:
        heads = (("messages", True), ("rate [Hz]", True), ("used as", False))
        columns = [Column("topic", whole=True), Column("type"), *(Column(*head) for head in heads)]
        rows = [
            (p.name, p.type.split("/")[-1], str(p.count), number_text(p.rate), p.used_as or "-")
            for p in survey.parts
        ]
    out.line(f"{survey.path}: {survey.format}")
    out.table("Topics" if "topic" in columns[0].head else "Columns", columns, rows)
    for part in survey.parts:
        if part.used_as and part.why:
            out.line(f"  {_MANY.get(part.used_as, part.used_as)}: {part.name} ({part.why})")
    reasons: dict[str, list[str]] = {}
    for part in survey.parts:
        if not part.used_as:
            reasons.setdefault(part.why, []).append(part.name)
    for why, names in reasons.items():
        out.line(f"  Not used: {', '.join(names)} ({why})")
    out.line()


def _show_streams(out: Output, streams: Sequence[Stream]) -> None:
    from slipwise.cli.output import Column

    columns = [Column("stream")]
    heads = ("runs", "samples", "duration [s]", "rate [Hz]", "gaps", "longest gap [s]", "frames")
    columns += [Column(head, True) for head in heads]
    rows = [
        (
            s.name,
            *(str(s.runs), str(s.samples), f"{s.seconds:.1f}", number_text(s.rate), str(s.gaps)),
            *(number_text(s.longest_gap), str(s.frames or "")),
        )
        for s in streams
    ]
    out.table("Streams", columns, rows)


def _show_timing(out: Output, timing: Sequence[Timing]) -> None:
    from slipwise.cli.output import Column

    columns = [Column("input"), Column("time"), Column("value [s]", True), Column("std [s]", True)]
    columns += [Column("identifiable"), Column("meaning")]
    rows = [
        (
            t.input,
            t.name,
            number_text(t.seconds),
            number_text(t.std, 2),
            "yes" if t.identifiable else "no",
            t.meaning,
        )
        for t in timing
    ]
    out.table("Clock offset, delay and lag between inputs and poses", columns, rows)


def _show_learnability(out: Output, item: Learnability, *, advise: bool) -> None:
    from slipwise.models.parameter_table import physical_name

    if item.missing:
        out.line(f"From {item.input}s nothing can be learned: {item.missing}")
        return
    known = [physical_name(p.name) for p in item.parameters if p.identifiable]
    unknown = [physical_name(p.name) for p in item.parameters if not p.identifiable]
    out.line(f"From {item.input}s: {count_text(item.windows, 'segment')}, {item.seconds:.0f} s of driving")
    out.line(f"  identifiable: {', '.join(known) or 'nothing'}")
    if unknown:
        out.line(f"  not identifiable: {', '.join(unknown)}")
    for entry in item.left_out:
        out.line(f"  {entry.count} left out: {entry.reason} (first at {entry.where})")
    for advice in item.advice if advise else ():
        out.line(f"  {advice}")

# SPDX-License-Identifier: Apache-2.0
"""`slipwise export`: files for other tools from a model file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import Json, ModelFile, optional

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.export import Exported, ExportOptions, Target
    from slipwise.models import Model


class TargetName(StrEnum):
    """The tool to write for."""

    diff_drive = "diff-drive"
    mppi = "mppi"
    amcl = "amcl"
    robot_localization = "robot-localization"
    c_header = "c-header"
    all = "all"


class Nav2(StrEnum):
    """Whose parameter names MPPI gets."""

    rolling = "rolling"
    kilted = "kilted"


def export(
    model: ModelFile,
    to: Annotated[TargetName, typer.Option("--to", show_default=False, help="The tool to write for.")],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="PATH", help="The file, or the folder to put files into."),
    ] = Path(),
    horizon: Annotated[float, typer.Option(metavar="SECONDS", help="Noise is right this far ahead.")] = 1.0,
    wheel_separation: Annotated[
        float | None, optional("METRES", "Nominal; tells left from right wheel radius.")
    ] = None,
    logged_separation_multiplier: Annotated[
        float, typer.Option(metavar="FACTOR", help="In force while the log was recorded.")
    ] = 1.0,
    logged_radius_multiplier: Annotated[
        float, typer.Option(metavar="FACTOR", help="In force while the log was recorded.")
    ] = 1.0,
    min_turning_radius: Annotated[
        float | None, optional("METRES", "Of an Ackermann vehicle, by its geometry.")
    ] = None,
    nav2: Annotated[Nav2, typer.Option("--nav2", help="Whose parameter names MPPI gets.")] = Nav2.rolling,
    surface: Annotated[str | None, optional("NAME", "One of the surfaces that the model remembers.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Export a model with a bad verdict, too.")] = False,
    json: Json = None,
) -> int:
    """Write a learned model into files for other tools: ros2_control, Nav2, robot_localization, C.

    `all` writes every file that the model has something to say for, and says what it left out and why. A
    model with a bad verdict is refused with exit code 1 unless --force is given.

    \b
    Examples:
      slipwise export model.yaml --to diff-drive -o diff_drive_controller.yaml
      slipwise export model.yaml --to all -o config/ --wheel-separation 0.57
      slipwise export commands.yaml --to mppi --nav2 kilted
      slipwise export model.yaml --to c-header -o model.h --json -
    """  # noqa: D301
    from slipwise.cli.bad_verdict import say_refused
    from slipwise.cli.output import Output
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.export import ExportOptions
    from slipwise.files import write_text_whole
    from slipwise.models import load_model, on_surface

    out = Output(json)
    refuse_unwritable(out.written_file, inputs=[model])
    options = ExportOptions(
        horizon=horizon,
        wheel_separation=wheel_separation,
        logged_separation_multiplier=logged_separation_multiplier,
        logged_radius_multiplier=logged_radius_multiplier,
        min_turning_radius=min_turning_radius,
        nav2="kilted" if nav2 is Nav2.kilted else "rolling",
    )
    learned = load_model(model) if surface is None else on_surface(load_model(model), surface)
    if not learned.content.verdict.good and not force:
        say_refused(out, learned, "export")
        return 1
    made = _make(learned, model.name, to, options)
    paths = _paths(made, output, to)
    refuse_unwritable(*paths.values(), out.written_file, inputs=[model])
    for target, exported in made.files:
        write_text_whole(paths[target.name], exported.text)
    _report(out, made, paths)
    return 0


@dataclass(frozen=True)
class _Made:
    files: list[tuple[Target, Exported]]
    left_out: list[tuple[str, str]]  # a target, and why it was left out


def _make(model: Model, name: str, to: TargetName, options: ExportOptions) -> _Made:
    """Make all texts before any is written; `all` leaves out what does not fit the model."""
    from slipwise.errors import ModelError
    from slipwise.export import TARGETS, export_model, find_target

    if to is not TargetName.all:
        target = find_target(to.value)
        return _Made([(target, export_model(model, target.name, name=name, options=options, force=True))], [])
    made = _Made([], [])
    for target in TARGETS:
        try:
            exported = export_model(model, target.name, name=name, options=options, force=True)
        except ModelError as problem:
            made.left_out.append((target.name, str(problem)))
        else:
            made.files.append((target, exported))
    if not made.files:
        raise ModelError(made.left_out[-1][1])
    return made


def _paths(made: _Made, output: Path, to: TargetName) -> dict[str, Path]:
    """Return where the files go, by target."""
    into_folder = to is TargetName.all or output.is_dir()
    return {target.name: output / target.file_name if into_folder else output for target, _ in made.files}


def _report(out: Output, made: _Made, paths: dict[str, Path]) -> None:
    from slipwise.cli.document import head
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_files

    document = {
        "exit_code": 0,
        "files": paths,
        "parameters": {target.name: exported.values for target, exported in made.files},
        "kept": {target.name: exported.kept for target, exported in made.files if exported.kept},
        "left_out": dict(made.left_out),
    }
    out.document(head("export") | document)
    rows = [
        (target.name, name, _value_text(value))
        for target, exported in made.files
        for name, value in exported.values.items()
    ]
    out.table("Exported", (Column("for", whole=True), Column("parameter"), Column("value")), rows)
    for target, exported in made.files:
        for name, reason in exported.kept.items():
            out.line(f"left at the tool's own value: {target.name}: {name}: {reason}")
    for name, reason in made.left_out:
        out.line(f"left out: {name}: {reason}")
    show_files(out, paths)


def _value_text(value: bool | float | str | Sequence[bool | float | str]) -> str:
    """Return a value in few digits; of a long list the numbers that are not zero."""
    from slipwise.number_text import number_text

    if isinstance(value, (bool, str)):
        return str(value)
    if isinstance(value, (int, float)):
        return number_text(float(value), 4)
    shown = value if len(value) <= 6 else [item for item in value if item]
    return " ".join(_value_text(item) for item in shown)

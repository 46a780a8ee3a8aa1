# SPDX-License-Identifier: Apache-2.0
"""`slipwise export`: files for other tools from a model file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import Json, ModelFile, ModelInput, optional

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
    autoware = "autoware"
    px4 = "px4"
    ardupilot = "ardupilot"
    c_header = "c-header"
    mounts = "mounts"
    all = "all"


class InputScale(StrEnum):
    """Whose numbers a scale of the log's input corrects."""

    log = "log"
    robot = "robot"


def export(
    model: ModelFile,
    to: Annotated[
        TargetName | None, typer.Option("--to", show_default=False, help="The tool to write for.")
    ] = None,
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
    ros_distro: Annotated[
        str | None,
        typer.Option(
            "--ros-distro",
            "--nav2",
            metavar="NAME",
            envvar="ROS_DISTRO",
            show_default=False,
            help="Release of ROS that the file is for: humble, jazzy, kilted, lyrical, rolling.",
        ),
    ] = None,
    update_rate: Annotated[float | None, optional("HZ", "Of the controller manager.")] = None,
    planning_horizon: Annotated[
        float, typer.Option(metavar="SECONDS", help="That MPPI plans ahead: time_steps times model_dt.")
    ] = 2.8,
    filter_rate: Annotated[
        float, typer.Option(metavar="HZ", help="Of robot_localization's filter: its frequency.")
    ] = 30.0,
    limits: Annotated[
        bool, typer.Option("--limits", help="Write limits too: as far as the poses show the body.")
    ] = False,
    stamped_commands: Annotated[
        bool | None,
        typer.Option(
            "--stamped-commands/--no-stamped-commands",
            show_default=False,
            help="Whether commands are TwistStamped.",
        ),
    ] = None,
    omni: Annotated[bool, typer.Option("--omni", help="The robot drives sideways, too.")] = False,
    small_alphas: Annotated[
        bool, typer.Option("--small-alphas", help="Write AMCL's alphas that are below its default, too.")
    ] = False,
    no_side_slip: Annotated[
        bool,
        typer.Option(
            "--no-side-slip", help="The robot does not slip sideways: what looks like it is a sensor's mount."
        ),
    ] = False,
    px4: Annotated[str | None, optional("VERSION", "Write for this PX4, such as 1.17.")] = None,
    ardupilot: Annotated[
        str | None, optional("VERSION", "Write for this ArduPilot Rover, such as 4.6.")
    ] = None,
    wheel_base: Annotated[float | None, optional("METRES", "Of a vehicle that steers.")] = None,
    logged: Annotated[
        list[str] | None,
        optional("NAME=VALUE", "The autopilot's parameter while the log was recorded; repeatable."),
    ] = None,
    input_scale: Annotated[
        InputScale | None, optional("log|robot", "Whose numbers --command-scale or --wheel-scale corrected.")
    ] = None,
    surface: Annotated[str | None, optional("NAME", "One of the surfaces that the model remembers.")] = None,
    merge: Annotated[
        Path | None,
        optional("FILE", "Your parameter file: show what changes in it; -o writes it, comments kept."),
    ] = None,
    input_name: ModelInput = None,
    force: Annotated[bool, typer.Option("--force", help="Export a model with a bad verdict, too.")] = False,
    json: Json = None,
) -> int:
    """Write a learned model into files for other tools: ros2_control, Nav2, PX4, C.

    `all` writes every file that the model has something to say for, and says what it left out and why. A
    model with a bad verdict is refused with exit code 1 unless --force is given.

    \b
    Examples:
      slipwise export model.yaml --to diff-drive --ros-distro jazzy -o diff_drive_controller.yaml
      slipwise export model.yaml --to all --ros-distro lyrical -o config/ --wheel-separation 0.57
      slipwise export commands.yaml --to mppi --ros-distro kilted --limits
      slipwise export model.yaml --merge nav2_params.yaml --ros-distro jazzy -o nav2_params.yaml
      slipwise export model.yaml --px4 1.17 -o rover.params
      slipwise export commands.yaml --ardupilot 4.6 --logged ATC_STR_RAT_FF=0.2
      slipwise export model.yaml --to c-header -o model.h --json -
    """  # noqa: D301
    given = locals()
    from slipwise.cli.bad_verdict import say_refused, without_bad_input
    from slipwise.cli.export_merge import merge_into
    from slipwise.cli.output import Output
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.export import ExportOptions, find_target
    from slipwise.files import write_text_whole
    from slipwise.models import load_model, on_surface

    out = Output(json)
    refuse_unwritable(out.written_file, inputs=[model])
    named = {each.name: given[each.name] for each in fields(ExportOptions)}
    options = ExportOptions(**named | {"ros_distro": ros_distro or None, "logged": _logged(logged or [])})
    no_target = merge is not None and px4 is None and ardupilot is None
    target = to or (TargetName.all if no_target else _of_firmware(px4, ardupilot))
    if target is not TargetName.all:
        _refuse_other_input(find_target(target.value), input_name)
        find_target(target.value).refuse_others(options)
    learned = load_model(model, input=input_name)
    learned = learned if surface is None else on_surface(learned, surface)
    if not force:
        learned, bad = without_bad_input(out, learned, target.value)
        if bad is not None:
            say_refused(out, bad, "export")
            return 1
    if merge is not None:
        files = (merge, None if output == Path() else output)
        return merge_into(out, learned, model.name, target.value, options, files)
    made = _make(learned, model.name, target, options)
    paths = _paths(made, output, target)
    refuse_unwritable(*paths.values(), out.written_file, inputs=[model])
    for written, exported in made.files:
        write_text_whole(paths[written.name], exported.text)
    _report(out, learned, made, paths)
    return 0


def _refuse_other_input(target: Target, asked: str | None) -> None:
    """Refuse an input that a target does not take, which whoever named it expects in its file."""
    from slipwise.errors import SettingsError
    from slipwise.models.inputs import MANY

    if asked is not None and target.input not in (None, asked):
        raise SettingsError(
            f"{target.name} is of {MANY[target.input]}", where="--input", advice="leave it out"
        )


def _logged(given: Sequence[str]) -> dict[str, float]:
    """Return parameters of an autopilot by their names."""
    from slipwise.errors import SettingsError

    found = {}
    for text in given:
        name, _, value = text.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            raise SettingsError(
                f"{text!r} is not a parameter", where="--logged", advice="give NAME=VALUE"
            ) from None
    return found


def _of_firmware(px4: str | None, ardupilot: str | None) -> TargetName:
    """Return the target that a named version asks for."""
    from slipwise.errors import SettingsError

    if (px4 is None) == (ardupilot is None):
        raise SettingsError(
            "Missing option '--to'", advice="name one tool, or a version with --px4 or --ardupilot"
        )
    return TargetName.px4 if ardupilot is None else TargetName.ardupilot


@dataclass(frozen=True)
class _Made:
    files: list[tuple[Target, Exported]]
    left_out: list[tuple[str, str]]  # a target, and why it was left out


def _make(model: Model, name: str, to: TargetName, options: ExportOptions) -> _Made:
    """Make all texts before any is written; `all` leaves out what does not fit the model."""
    from slipwise.errors import ModelError
    from slipwise.export import TARGETS, export_model, find_target
    from slipwise.models.mounted import mounts_in

    if to is not TargetName.all:
        target = find_target(to.value)
        return _Made([(target, export_model(model, target.name, name=name, options=options, force=True))], [])
    made = _Made([], [])
    mounted = options.no_side_slip or mounts_in(model)
    for target in (*TARGETS, *((find_target("mounts"),) if mounted else ())):
        try:
            exported = export_model(model, target.name, name=name, options=options, force=True)
        except ModelError as problem:
            made.left_out.append((target.name, str(problem)))
        else:
            made.files.append((target, exported))
    if not made.files:
        raise ModelError("; ".join(f"{name}: {reason}" for name, reason in made.left_out))
    return made


def _paths(made: _Made, output: Path, to: TargetName) -> dict[str, Path]:
    """Return where the files go, by target."""
    into_folder = to is TargetName.all or output.is_dir()
    return {target.name: output / target.file_name if into_folder else output for target, _ in made.files}


def _report(out: Output, model: Model, made: _Made, paths: dict[str, Path]) -> None:
    from slipwise.cli.document import head
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_files
    from slipwise.models.inputs import MANY

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
    either = [target.name for target, _ in made.files if target.input is None]
    if either and len(model.inputs) > 1:
        used, other = model.inputs
        out.line(f"For {MANY[used]}: {', '.join(either)}; --input {other} writes these for {MANY[other]}.")
    if rows:
        out.table("Exported", (Column("for", whole=True), Column("parameter"), Column("value")), rows)
    else:
        out.line("No parameter could be written; the file holds the reasons alone:")
    for target, exported in made.files:
        for name, reason in exported.kept.items():
            out.line(f"{target.name}: {name} not written, its default stays: {reason}")
    for name, reason in made.left_out:
        out.line(f"{name} skipped: {reason}")
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

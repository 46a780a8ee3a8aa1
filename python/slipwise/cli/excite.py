# SPDX-License-Identifier: Apache-2.0
"""`slipwise excite`: the drive that teaches most, as commands to play."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import Force, Json, optional

if TYPE_CHECKING:
    from slipwise.excitation import CommandSpace, Excitation, Knowledge, Lesson, Vehicle
    from slipwise.models import Model


def excite(
    area: Annotated[
        str, typer.Option(metavar="WxD", help="Free ground: metres along the first heading, and across.")
    ] = "8x8",
    minutes: Annotated[float, typer.Option(metavar="MIN", help="The drive takes no longer.")] = 1.0,
    vehicle: Annotated[
        str | None, optional("NAME", "Limits and size of husky, jackal, warthog, turtlebot4, and others.")
    ] = None,
    model: Annotated[
        Path | None, optional("FILE", "Model to start from; the learner's prior by default.")
    ] = None,
    prior: Annotated[
        Path | None, optional("FILE", "What a fleet knows of its next robot, by `slipwise fleet`.")
    ] = None,
    speed: Annotated[
        float | None, optional("M/S", "Speed limit; the vehicle's or the model's range.")
    ] = None,
    yaw_rate: Annotated[float | None, optional("RAD/S", "Limit of the yaw rate; likewise.")] = None,
    lateral: Annotated[float | None, optional("M/S^2", "Limit of speed times yaw rate; none.")] = None,
    radius: Annotated[float | None, optional("METRES", "Of a disc that covers the robot.")] = None,
    hold: Annotated[float, typer.Option(metavar="SECONDS", help="How long a command is held.")] = 2.0,
    pause: Annotated[float, typer.Option(metavar="SECONDS", help="Standing after each command.")] = 0.5,
    topic: Annotated[str, typer.Option(metavar="TOPIC", help="Of the commands in the bag.")] = "/cmd_vel",
    stamped: Annotated[bool, typer.Option("--stamped", help="TwistStamped in the bag, not Twist.")] = False,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="STEM", help="Files STEM.csv, STEM.mcap and STEM.html.")
    ] = Path("excite"),
    force: Force = False,
    json: Json = None,
) -> int:
    """Find the held commands after which the robot's worst prediction is surest, inside an area.

    The drive ends where it began and does to the right what it does to the left. It was tried on 10 000
    robots with slip, lag and delay a quarter more varied than is likely: all stay inside. Nothing is sent to
    any robot: a person plays the bag, with the stop button in hand, and records poses meanwhile. A model with
    a bad verdict is refused with exit code 1 unless --force is given.

    \b
    Examples:
      slipwise excite --area 8x8 --minutes 1 --vehicle husky
      slipwise excite --area 20x10 --minutes 2 --speed 1.5 --yaw-rate 1 --radius 0.7 -o first
      slipwise excite --area 8x8 --vehicle husky --model model.yaml -o second
      slipwise excite --area 8x8 --vehicle husky --prior fleet/fleet.yaml
    """  # noqa: D301
    from dataclasses import replace

    from slipwise.cli.bad_verdict import say_refused
    from slipwise.cli.numbers import area_of
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.excitation import ExcitationOptions, design_drive, lessons_of
    from slipwise.live.wires.wire import require_topic
    from slipwise.reporting.excitation_page import summary

    out = Output(json)
    require_topic(topic)
    files = {kind: output.with_name(f"{output.name}.{kind}") for kind in ("csv", "mcap", "html")}
    refuse_unwritable(*files.values(), out.written_file, inputs=[model, prior])
    robot = _vehicle(vehicle)
    given = {"speed": speed, "yaw_rate": yaw_rate, "lateral": lateral}
    learned = _learned(model, prior)
    space, knowledge = _known((learned, prior), robot, given)
    if learned is not None and not learned.verdict.good and not force:
        say_refused(out, learned, "excite")
        return 1
    options = ExcitationOptions(area=area_of(area, "--area"), minutes=minutes, hold=hold, pause=pause)
    size = radius if radius is not None else robot.radius if robot is not None else options.radius
    options = replace(options, radius=size)
    with progress_bar("searching") as update:
        designed = design_drive(
            knowledge, space, options, progress=lambda fraction: update("searching", fraction)
        )
    lessons = lessons_of(designed)
    _write(files, designed, lessons, (topic, stamped))
    document = _document(designed, lessons, files)
    in_reverse = "" if learned is None else _reverse(learned, designed)
    for sentence in filter(None, (*summary(designed, lessons), in_reverse)):
        out.line(sentence)
    show_files(out, files)
    out.document(document)
    return int(document["exit_code"])


def _vehicle(name: str | None) -> Vehicle | None:
    from slipwise.excitation import vehicle_named

    return None if name is None else vehicle_named(name)


def _learned(model: Path | None, prior: Path | None) -> Model | None:
    from slipwise.errors import SettingsError
    from slipwise.models import load_model

    if model is None:
        return None
    if prior is not None:
        raise SettingsError("a model of this robot takes the place of its fleet's prior", where="--prior")
    learned = load_model(model, input="command")
    learned.refuse_throttle("designed drives")
    return learned


def _known(
    known: tuple[Model | None, Path | None], vehicle: Vehicle | None, given: dict[str, float | None]
) -> tuple[CommandSpace, Knowledge]:
    """Return the limits of the commands and the start, of a model or a fleet's prior."""
    from slipwise.calibration.from_prior import KnownFleet
    from slipwise.calibration.new_robot import new_robot_knowledge
    from slipwise.errors import SettingsError
    from slipwise.excitation import CommandSpace, knowledge_of, prior_knowledge
    from slipwise.models.axes import axes_of
    from slipwise.planning import limits_of

    learned, prior = known
    limits: dict[str, float] = {}
    if learned is not None and vehicle is None:
        of_model = limits_of(learned)
        limits = {"speed": of_model.speed, "yaw_rate": of_model.yaw_rate}
    elif vehicle is not None:
        limits = {name: getattr(vehicle.space, name) for name in ("speed", "yaw_rate", "lateral")}
    if learned is not None and axes_of(learned).sideways:
        limits["sideways"] = _sideways_limit(learned)
    if learned is not None and learned.steers:
        limits["curvature"] = limits_of(learned).curvature
    limits |= {name: value for name, value in given.items() if value is not None}
    if "speed" not in limits or "yaw_rate" not in limits:
        raise SettingsError(
            "the limits of the robot are unknown",
            where="--vehicle",
            advice="give --vehicle, or --speed, --yaw-rate and --radius",
        )
    space = CommandSpace(**limits)
    if prior is not None:
        return space, new_robot_knowledge(KnownFleet.load(prior))
    if learned is None or not learned.vector.rows:  # the baseline predicts best
        return space, prior_knowledge(space)
    return space, knowledge_of(learned)


def _reverse(model: Model, drive: Excitation) -> str:
    """Say that the robot is to drive in reverse, where its model never saw it do so; else empty."""
    from slipwise.excitation import command_inputs
    from slipwise.number_text import number_text

    slowest = float(command_inputs(drive).v.min())
    if slowest >= 0.0 or model.content.range.speed[0] < 0.0:
        return ""
    return f"It drives in reverse, down to {number_text(slowest)} m/s, which the model has never seen."


def _sideways_limit(model: Model) -> float:
    """How fast the robot was driven sideways, or at all where an older model does not say it [m/s]."""
    seen = model.content.range
    return max(map(abs, seen.sideways or seen.speed))


def _write(
    files: dict[str, Path], drive: Excitation, lessons: tuple[Lesson, ...], sent: tuple[str, bool]
) -> None:
    from slipwise.excitation import write_command_bag, write_commands
    from slipwise.files import write_text_whole
    from slipwise.reporting.excitation_page import excitation_page

    topic, stamped = sent
    write_commands(files["csv"], drive)
    write_command_bag(files["mcap"], drive, topic=topic, stamped=stamped)
    write_text_whole(files["html"], excitation_page(drive, lessons, files["csv"].stem))


def _document(drive: Excitation, lessons: tuple[Lesson, ...], files: dict[str, Path]) -> dict[str, Any]:
    from slipwise.cli.document import head

    return head("excite") | {
        "exit_code": 0,
        "files": files,
        "seconds": drive.seconds,
        "start": drive.start,
        "area": drive.options.area,
        "parameters": drive.knowledge.names,
        "lessons": [
            {
                "v": lesson.move.v if lesson.move else None,
                "vy": lesson.move.vy if lesson.move else None,
                "omega": lesson.move.omega if lesson.move else None,
                "worst_yaw_std": lesson.yaw,
                "worst_position_std": lesson.position,
                "std": lesson.std.tolist(),
            }
            for lesson in lessons
        ],
    }

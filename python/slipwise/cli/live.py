# SPDX-License-Identifier: Apache-2.0
"""`slipwise live`: learn while the robot drives."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Protocol

import typer

from slipwise.cli.options import (
    Changes,
    Input,
    SettingsFile,
    chosen_settings,
    optional,
    takes_log_options,
)
from slipwise.stop_signals import Stopped, taken_by

if TYPE_CHECKING:
    from types import FrameType

    from slipwise.logs import LogOptions


@takes_log_options
def live(
    log_options: LogOptions,
    transport: Annotated[
        str | None,
        optional(
            "NAME",
            "ros (default: rclpy, else cyclonedds), rclpy, cyclonedds, stdin or udp.",
        ),
    ] = None,
    replay: Annotated[Path | None, optional("LOG", "Replay a log in place of a robot.")] = None,
    rate: Annotated[
        float, typer.Option(metavar="TIMES", help="Speed of --replay; 0: as fast as it goes.")
    ] = 1.0,
    demo: Annotated[
        bool,
        typer.Option("--demo", help="Drive a simulated robot through a slalom whose floor changes (MuJoCo)."),
    ] = False,
    input_name: Input = None,
    settings: SettingsFile = None,
    changes: Changes = None,
    name: Annotated[
        str | None, optional("NAME", "Name of the robot; the cache keeps each robot apart. Default robot.")
    ] = None,
    model: Annotated[
        Path | None, optional("MODEL", "Use this model until a better one is learned.", "--model")
    ] = None,
    memory: Annotated[
        bool,
        typer.Option("--memory", help="Remember surfaces and recall them, those of --model included."),
    ] = False,
    surface: Annotated[
        str | None, optional("NAME", "With --memory: name of the surface at the start.")
    ] = None,
    cache: Annotated[
        Path | None, optional("DIR", "Keep what was learned here, and continue from it at the next start.")
    ] = None,
    output: Annotated[
        Path | None, optional("MODEL.yaml", "Write the model here at the end.", "-o", "--output")
    ] = None,
    results: Annotated[
        Path | None,
        optional("FILE", "With --transport stdin: write results here as JSON lines; - is standard output."),
    ] = None,
    web: Annotated[int | None, optional("PORT", "Serve a web page; default port 8088.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show errors only.")] = False,
) -> int:
    """Learn while the robot drives, and publish the learned model.

    Reads commands, wheel speeds and poses; publishes odometry with learned slip, the path ahead, the model
    and its validity below the node's name. Ctrl-C or SIGTERM ends it and writes the cache. Settings: [live],
    such as apply, network, address.

    \b
    Examples:
      slipwise live --pose-topic /rtk/odom --cache ~/.slipwise --name husky-1
      slipwise live --transport cyclonedds --web --set live.apply.mode=auto
      slipwise live --replay drive.mcap --rate 10 --web
      slipwise live --memory --model monday.yaml -o tuesday.yaml
      slipwise live --demo --web
      robot-log | slipwise live --transport stdin --results -
    """  # noqa: D301
    from slipwise.cli.live_parts import (
        Source,
        live_settings,
        model_of_replay,
        open_robot,
        settled,
        watchers_for,
        with_memory,
    )
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.live.build import build_node

    given = {
        "transport": transport, "name": name, "model": model and str(model), "memory": memory or None,
        "cache": cache and str(cache), "input": input_name,
        "surface": surface,
    }  # fmt: skip
    chosen = live_settings(chosen_settings(settings, changes), given)
    chosen = with_memory(chosen)
    table = chosen.live
    start = None if table.model is None else Path(table.model)
    to_file = None if results is None or str(results) == "-" else results
    refuse_unwritable(
        output,
        to_file,
        inputs=(replay, settings, start, *log_options.files),
    )
    instead = "--demo" if demo else "--replay" if replay is not None else None
    _refuse_unheeded(table.transport, transport, results, instead=instead, rate=rate)
    shown = Shown(quiet or (results is not None and str(results) == "-"), web)
    stopping = Stopping()
    try:
        with taken_by(stopping):
            source = Source(replay, demo, rate, results)
            robot = open_robot(chosen, log_options, source, say=shown.say)
            chosen = settled(chosen, log_options, robot.coming)
            watchers = watchers_for(shown, chosen.live)
            timeout = None if robot.log is not None else log_options.command_timeout  # a log has it already
            built = build_node(
                robot.transport,
                robot.input_name,
                chosen,
                watchers=watchers,
                run=robot.run,
                command_timeout=timeout,
                read=log_options,
            )
            if robot.log is not None:
                built.learning.learner.know_log(robot.log)
            stopping.node = built.node
            if table.duration is not None:
                timer = threading.Timer(table.duration, built.node.stop)
                timer.daemon = True
                timer.start()
            built.node.run()
    except Stopped:
        shown.say("stopped before anything came")
        return 0
    if output is not None:
        model_of_replay(built, robot.log).save(output)
        shown.say(f"model: {output}")
    return 0


def _refuse_unheeded(
    settled: str | None, given: str | None, results: Path | None, *, instead: str | None, rate: float
) -> None:
    """Refuse options that would change nothing.

    Raises:
        SettingsError: `instead` of a transport samples come from elsewhere; or there are no lines to answer.
    """
    from slipwise.errors import SettingsError

    if instead and given is not None:
        raise SettingsError(
            f"{instead} stands in for a robot", where="--transport", advice="leave one of the two out"
        )
    if rate != 1.0 and not instead:
        raise SettingsError("samples come as they are sent", where="--rate", advice="give --replay with it")
    if results is not None and (instead or settled != "stdin"):
        raise SettingsError(
            "results answer lines", where="--results", advice="give --transport stdin with it"
        )


class Shown:
    """What the user sees, and where."""

    def __init__(self, quiet: bool, web: int | None) -> None:
        self.quiet, self.web = quiet, web

    def say(self, text: str) -> None:
        """Print a line."""
        if not self.quiet:
            from slipwise.cli.output import Output

            Output(None).line(text)


class Stoppable(Protocol):
    """What can be ended from a signal."""

    def stop(self) -> None:
        """End it in order."""


class Stopping:
    """Ends the node on a signal; before there is one, the signal interrupts what goes on."""

    node: Stoppable | None = None

    def __call__(self, _signal: int, _frame: FrameType | None) -> None:
        """Take a signal."""
        if self.node is None:
            raise Stopped
        self.node.stop()

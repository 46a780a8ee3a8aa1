# SPDX-License-Identifier: Apache-2.0
"""`slipwise live`: learn while the robot drives."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Protocol

import typer

from slipwise.cli.memory_options import BEGIN_WITH_NOTHING
from slipwise.cli.options import (
    Basis,
    BodyForce,
    Input,
    Seed,
    SettingsFile,
    chosen_settings,
    optional,
    takes_log_options,
)

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
            "ros (the default: rclpy, or cyclonedds where there is no rclpy), one of these, stdin or udp.",
        ),
    ] = None,
    replay: Annotated[Path | None, optional("LOG", "Take the samples of a log.")] = None,
    rate: Annotated[float, typer.Option(metavar="TIMES", help="Speed of --replay; 0: no waits.")] = 1.0,
    demo: Annotated[
        bool,
        typer.Option("--demo", help="Drive a simulated robot through a slalom whose floor changes (MuJoCo)."),
    ] = False,
    seed: Seed = 1,
    input_name: Input = None,
    basis: Basis = None,
    body_force: BodyForce = None,
    settings: SettingsFile = None,
    name: Annotated[str | None, optional("NAME", "Of the node; default slipwise.")] = None,
    vehicle: Annotated[str | None, optional("NAME", "Whose model it is; the cache goes by it.")] = None,
    domain: Annotated[int | None, optional("N", "ROS domain; default ROS_DOMAIN_ID, else 0.")] = None,
    network: Annotated[bool, typer.Option("--network", help="Reach beyond this host.")] = False,
    address: Annotated[str | None, optional("HOST:PORT", "Where --transport udp listens.")] = None,
    override_topic: Annotated[
        str | None,
        optional("TOPIC", "std_msgs/Bool, true while an operator drives past the commands."),
    ] = None,
    model: Annotated[
        Path | None, optional("MODEL", "What others get until something valid is learned.", "--model")
    ] = None,
    memory: Annotated[
        str | None,
        optional(
            "[MODEL.yaml]",
            "Remember surfaces, and recall them; begin with those of a model file.",
        ),
    ] = None,
    terrain: Annotated[
        str | None, optional("LABEL", "With --memory: name of the surface at the start.")
    ] = None,
    terrain_topic: Annotated[
        str | None,
        optional("TOPIC", "With --memory: std_msgs/String with the surface's name, beside ~/terrain."),
    ] = None,
    cache: Annotated[Path | None, optional("DIR", "Keep here what was learned.")] = None,
    output: Annotated[
        Path | None, optional("MODEL.yaml", "Write the model here at the end.", "-o", "--output")
    ] = None,
    apply: Annotated[
        str | None, optional("MODE", "Hand parameters on: off (the default), manual or auto.")
    ] = None,
    results: Annotated[
        Path | None, optional("FILE", "stdin: write results as JSON lines; - is standard output.")
    ] = None,
    web: Annotated[int | None, optional("PORT", "Serve a page to watch; without a port 8088.")] = None,
    foxglove: Annotated[
        int | None, optional("PORT", "Serve Foxglove and Lichtblick; without a port 8765.")
    ] = None,
    host: Annotated[str, typer.Option(metavar="HOST", help="Where these two listen.")] = "127.0.0.1",
    record: Annotated[Path | None, optional("FILE.mcap", "Record all that the node gives.")] = None,
    duration: Annotated[
        float | None, optional("SECONDS", "Stop after this time of the wall clock.", "--for")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show nothing but errors.")] = False,
) -> int:
    """Learn while the robot drives, and tell planners, odometry and people.

    Hears commands, wheel speeds and poses, and gives odometry with learned slip, the path ahead, the model
    and its validity below the node's name. Ctrl-C or SIGTERM ends it, with the cache written. All of this
    can stand in a settings file, under [live].

    \b
    Examples:
      slipwise live --pose-topic /rtk/odom --cache ~/.slipwise --vehicle husky-1
      slipwise live --transport cyclonedds --web --apply auto --settings live.toml
      slipwise live --replay drive.mcap --rate 10 --web
      slipwise live --memory monday.yaml --terrain-topic /terrain/label -o tuesday.yaml
      slipwise live --demo --web
      robot-log | slipwise live --transport stdin --results -
    """  # noqa: D301
    from slipwise.cli.live_parts import (
        Source,
        for_the_ground,
        live_settings,
        model_of_replay,
        open_robot,
        watchers_for,
        with_memory,
    )
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.live.build import build_node

    given = {
        "transport": transport, "name": name, "vehicle": vehicle, "domain": domain, "address": address,
        "network": network or None, "override_topic": override_topic, "model": model and str(model),
        "memory": memory and (memory == BEGIN_WITH_NOTHING or memory), "terrain": terrain,
        "terrain_topic": terrain_topic,
        "cache": cache and str(cache), "input": input_name and input_name.value, "apply": apply,
    }  # fmt: skip
    chosen = live_settings(chosen_settings(settings, basis, body_force=body_force), given)
    chosen = with_memory(chosen, chosen=bool(settings or basis or body_force))
    begun = Path(chosen.live.memory) if isinstance(chosen.live.memory, str) else None
    to_file = None if results is None or str(results) == "-" else results
    refuse_unwritable(output, record, to_file, inputs=(replay, settings, model, begun, *log_options.files))
    shown = Shown(quiet or (results is not None and str(results) == "-"), web, foxglove, host, record)
    with stopped_by_signals() as stopping:
        source = Source(replay, demo, seed, rate, results)
        robot = open_robot(chosen, log_options, source, say=shown.say)
        if robot.positions:
            chosen = live_settings(chosen, {"positions": True})
        if robot.gyro_alone:
            chosen = live_settings(chosen, {"gyro_alone": True})
        if robot.sources:
            chosen = live_settings(chosen, {"sources": list(robot.sources)})
        chosen = for_the_ground(chosen, robot.log)
        watchers = watchers_for(shown, chosen.live)
        timeout = None if robot.log is not None else log_options.command_timeout  # a log has it already
        built = build_node(
            robot.transport,
            robot.input_name,
            chosen,
            watchers=watchers,
            run=robot.run,
            command_timeout=timeout,
        )
        if robot.log is not None:
            built.learning.learner.know_log(robot.log)
        stopping.node = built.node
        if duration is not None:
            timer = threading.Timer(duration, built.node.stop)
            timer.daemon = True
            timer.start()
        built.node.run()
    if output is not None:
        model_of_replay(built, robot.log).save(output)
        shown.say(f"model: {output}")
    return 0


class Shown:
    """What the user sees, and where."""

    def __init__(
        self, quiet: bool, web: int | None, foxglove: int | None, host: str, record: Path | None
    ) -> None:
        self.quiet, self.web, self.foxglove, self.host, self.record = quiet, web, foxglove, host, record

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
            raise KeyboardInterrupt
        self.node.stop()


@contextlib.contextmanager
def stopped_by_signals() -> Iterator[Stopping]:
    """Let SIGINT and SIGTERM end the node in order."""
    stopping = Stopping()
    before = {number: signal.signal(number, stopping) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stopping
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)

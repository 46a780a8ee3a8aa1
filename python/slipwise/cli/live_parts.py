# SPDX-License-Identifier: Apache-2.0
"""What `slipwise live` is given: where samples come from, and who watches."""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Protocol

from slipwise.errors import LogError, SettingsError

if TYPE_CHECKING:
    from slipwise.calibration import Settings
    from slipwise.calibration.coming import Coming
    from slipwise.calibration.live_table import LiveTable
    from slipwise.live.build import Built
    from slipwise.live.transport import Transport
    from slipwise.live.watch.watcher import Watcher
    from slipwise.logs import Log, LogOptions
    from slipwise.models import Model


@dataclass(frozen=True)
class Robot:
    """Where samples come from."""

    transport: Transport
    input_name: str
    run: str | None  # name of the run that begins; None: the transport says
    log: Log | None = None  # that is replayed
    coming: Coming | None = None  # what is known to come; None: what the settings say


@dataclass(frozen=True)
class Source:
    """What stands in for a robot on ROS."""

    replay: Path | None
    demo: bool
    rate: float  # times real time
    results: Path | None


class Show(Protocol):
    """What the user wants to see."""

    quiet: bool
    web: int | None

    def say(self, text: str) -> None:
        """Print a line."""


def live_settings(settings: Settings, given: Mapping[str, Any]) -> Settings:
    """Return the settings with what the command line gives under [live].

    Raises:
        SettingsError: a value is impossible.
    """
    from pydantic import ValidationError

    from slipwise.calibration.live_table import LiveTable
    from slipwise.validation_text import first_problem

    content = settings.live.model_dump()
    own = {name: value for name, value in given.items() if value is not None}
    if "apply" in own:
        content["apply"] = content["apply"] | {"mode": own.pop("apply")}
    try:
        table = LiveTable.model_validate(content | own)
    except ValidationError as problem:
        raise SettingsError(
            first_problem(problem), where="slipwise live", advice="see `slipwise live --help`"
        ) from problem
    return settings.model_copy(update={"live": table})


def settled(settings: Settings, options: LogOptions, coming: Coming | None) -> Settings:
    """Return the settings with what the options say of the robot, and what is known to come.

    Raises:
        SettingsError: a value is impossible.
    """
    if options.car is not None:  # commands are throttle and steering
        settings = live_settings(settings, {"vehicle": options.vehicle})
    elif options.wheelbase is not None:  # commands steer
        settings = live_settings(settings, {"wheelbase": options.wheelbase})
    return settings if coming is None else live_settings(settings, coming.settings())


def with_memory(settings: Settings) -> Settings:
    """Return the settings with which a memory of surfaces is continued.

    They are those of the model that it is continued from, unless other settings of learning are given.

    Raises:
        ModelError: the model cannot be read.
        SettingsError: a surface is named, but none is remembered.
    """
    from slipwise.calibration.calibrate_sequence import settings_of
    from slipwise.cli.memory_options import refuse_labels
    from slipwise.live.model_file import surfaces_before

    table = settings.live
    if not table.memory:
        refuse_labels([label for label in (table.surface, table.surface_topic) if label])
        return settings
    before = surfaces_before(table)
    defaults = type(settings)().model_dump(exclude={"log"})
    if before is None or settings.model_dump(exclude={"log"}) != defaults:
        return settings
    return settings_of(before).model_copy(update={"live": table})


def open_robot(
    settings: Settings,
    options: LogOptions,
    source: Source,
    *,
    say: Callable[[str], None],
) -> Robot:
    """Return where samples come from.

    Raises:
        SlipwiseError: the log, the topics or the address cannot be used.
    """
    table = settings.live
    if source.demo:
        from slipwise.plugins import ROBOTS, load

        return Robot(load(ROBOTS, "demo")(rate=source.rate), "command", "the slalom")
    if source.replay is not None:
        return _replayed(table, options, source.replay, source.rate)
    if table.transport in ("stdin", "udp"):
        return _of_lines(table, options, source, say)
    return _ros(table, options, say)


def _replayed(table: LiveTable, options: LogOptions, replay: Path, rate: float) -> Robot:
    from slipwise.calibration.coming import coming_of
    from slipwise.calibration.prepared_run import choose_input
    from slipwise.live.replay import Replay
    from slipwise.logs import open_log

    log = open_log(replay, options=options)
    input_name = table.input or choose_input(log)
    replayed = Replay(log, input_name, rate=rate, label=table.surface)
    return Robot(replayed, input_name, None, log, coming_of(log))


def _of_lines(table: LiveTable, options: LogOptions, source: Source, say: Callable[[str], None]) -> Robot:
    from slipwise.live.pipe import Pipe
    from slipwise.live.udp import DEFAULT_ADDRESS, Udp

    if table.transport == "stdin":
        lines: Pipe | Udp = Pipe(_standard_input(), _results(source.results), options)
        name = "standard input"
    else:
        lines = Udp(table.address or DEFAULT_ADDRESS, options)
        name = "UDP"
        say(f"listening on UDP port {lines.port}")
    say(f"waiting for the first lines of {name}")
    coming = lines.look(table.duration or math.inf) if isinstance(lines, Udp) else lines.look()
    input_name = table.input or coming.input_name
    say(f"learning from {input_name}s{coming.words()}")
    return Robot(
        lines, input_name, name, coming=replace(coming, sideways=coming.sideways or options.sideways)
    )


def _ros(table: LiveTable, options: LogOptions, say: Callable[[str], None]) -> Robot:
    from slipwise.live.ros_robot import find_robot
    from slipwise.live.wires.make_wire import make_wire
    from slipwise.live.wires.wire import WireOptions

    named = WireOptions(node_name=table.node, domain=table.domain, network=table.network)
    wire = make_wire(None if table.transport in (None, "ros") else table.transport, named)
    found = find_robot(wire, table, options, say, name=table.node)
    return Robot(found.transport, found.input_name, "live", coming=found.coming)


def _standard_input() -> IO[bytes]:
    """Return what can be stopped, unless a program has put a stream of its own there."""
    from slipwise.live.stoppable_reader import StoppableReader

    try:
        return StoppableReader(sys.stdin.buffer.fileno())
    except OSError:
        return sys.stdin.buffer


def _results(path: Path | None) -> Any:
    if path is None:
        return None
    if str(path) == "-":
        sys.stdout.flush()
        return os.fdopen(os.dup(sys.stdout.fileno()), "wb", buffering=0)
    return path.open("wb", buffering=0)


def watchers_for(show: Show, table: LiveTable) -> list[Watcher]:
    """Return who watches, and say where.

    Raises:
        SlipwiseError: an address or a file cannot be used, or a package is missing.
    """
    from slipwise.live.watch.terminal import ErrorLines

    found: list[Watcher] = []
    headlines = []
    with contextlib.ExitStack() as undo:
        if show.web is not None:
            from slipwise.live.watch.web_page import WebPage

            page = WebPage(host=table.host, port=show.web)
            undo.callback(page.close)
            found.append(page)
            headlines.append(f"page: {page.url}")
        found.append(ErrorLines(_complain) if show.quiet else _terminal(show, headlines))
        undo.pop_all()
    return found


def _complain(text: str) -> None:
    with contextlib.suppress(OSError):
        print(f"slipwise: {text}", file=sys.stderr, flush=True)


def _terminal(show: Show, headlines: list[str]) -> Watcher:
    from rich.console import Console

    from slipwise.live.watch.terminal import terminal_watcher

    return terminal_watcher(Console(markup=False, emoji=False), show.say, headlines=headlines)


def model_of_replay(built: Built, log: Log | None) -> Model:
    """Return the model of all that was learned; of a replayed log alone, what `calibrate` makes of it.

    Raises:
        LogError: nothing was learned.
    """
    if not built.learning.learner.learned:
        advice = "drive for some seconds first"
        if most := built.said.counts.most_common(1):
            advice += f"; {most[0][1]} times a measurement was left out: {most[0][0]}"
        raise LogError("nothing was learned: no model is written", advice=advice)
    whole = None if built.goes_on else log
    return built.learning.learner.judged_model(log=whole)[0]

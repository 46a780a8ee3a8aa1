# SPDX-License-Identifier: Apache-2.0
"""The entry point `slipwise`: registers the commands; each loads what it needs only when it is called."""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any

import typer

from slipwise.cli.calibrate import calibrate
from slipwise.cli.compare import compare
from slipwise.cli.convert import convert
from slipwise.cli.doctor import doctor
from slipwise.cli.errors import exit_code_of
from slipwise.cli.evaluate import evaluate
from slipwise.cli.excite import excite
from slipwise.cli.export import export
from slipwise.cli.fleet import fleet
from slipwise.cli.help_pages import GroupedCommands
from slipwise.cli.inspect import inspect
from slipwise.cli.lattice import lattice
from slipwise.cli.live import live
from slipwise.cli.older_names import notes_of_warnings, with_new_names, with_ports
from slipwise.cli.plan import plan
from slipwise.cli.score import score
from slipwise.cli.show import show
from slipwise.cli.surfaces import surfaces
from slipwise.cli.terrain import terrain
from slipwise.plugins import COMMANDS, added, refuse_missing

DEBUG = "--debug"
app = typer.Typer(
    name="slipwise",
    cls=GroupedCommands,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
_COMMANDS = (
    (inspect, "Show what is in a log and what can be learned from it."),
    (doctor, "Say what is wrong with a robot's clocks, topics, units, signs and poses."),
    (calibrate, "Learn a motion model from logs."),
    (evaluate, "Compare methods on logs that they have not seen."),
    (show, "Show what a model has learned."),
    (compare, "Test whether a new model predicts better than an old one."),
    (excite, "Find the drive that teaches most, inside an area."),
    (export, "Write a model into files for other tools."),
    (live, "Learn while the robot drives."),
    (plan, "Plan a route through a map with a learned model."),
    (lattice, "Write primitives that the robot can drive, for Nav2."),
    (convert, "Write logs as a tidy table or as MCAP."),
    (score, "Score any method's prediction file on a log."),
    (fleet, "Learn many logs of many robots, and show what stands out."),
)
for _command, _summary in _COMMANDS:
    app.command(_command.__name__, short_help=_summary)(_command)
for _name, _entry in added(COMMANDS).items():
    _module = _entry.load()
    app.command(_name, short_help=_module.SUMMARY)(getattr(_module, _name))
app.add_typer(surfaces, name="surfaces", short_help="Merge and name the surfaces that models remember.")
app.add_typer(terrain, name="terrain", short_help="Classify the surface by vibration and motor currents.")


def _show_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"slipwise {version('slipwise')}")
        raise typer.Exit


@app.callback()
def _slipwise(
    debug: Annotated[bool, typer.Option(DEBUG, help="Show the traceback of an unexpected error.")] = False,
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
    ] = False,
) -> None:
    """Learn a robot's motion model - slip, lag, delay, uncertainty - from its commands and where it went.

    Exit codes: 0 good, 1 not good enough, 2 bad input or use. demo, calibrate, evaluate and reproduce keep
    each run in runs/<UTC time>-<command>; runs/latest is the last one.

    \b
    Examples:
      slipwise demo
      slipwise inspect drive.mcap
      slipwise calibrate drive.mcap -o model.yaml
      slipwise evaluate other.mcap --model model.yaml
      slipwise export model.yaml --to all -o config/
    """  # noqa: D301 - \b keeps the lines below it as they are


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave the process with its exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    gc.set_threshold(50_000, 20, 20)  # looking for garbage took a twelfth of a short run
    sys.exit(run(given))


def run(arguments: Sequence[str]) -> int:
    """Run one command; return its exit code: 0 success, 1 not good enough, 2 bad input or use."""
    plain = [argument for argument in arguments if argument != DEBUG] or ["--help"]
    return exit_code_of(lambda: _invoke(with_ports(with_new_names(plain))), debug=DEBUG in arguments)


def _invoke(arguments: list[str]) -> int:
    refuse_missing(COMMANDS, arguments[0])
    command = _command_line()
    with notes_of_warnings(), command.make_context("slipwise", arguments) as context:
        return int(command.invoke(context) or 0)


@cache
def _command_line() -> Any:
    """Make the whole command line, once a process: it takes longer than a command that is refused."""
    return typer.main.get_command(app)


if __name__ == "__main__":
    main()

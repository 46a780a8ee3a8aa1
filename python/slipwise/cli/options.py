# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share, each stated once."""

from __future__ import annotations

import contextlib
import functools
import inspect
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.help_pages import show_options
from slipwise.log_fields import LOG_FIELDS, About, Kind

if TYPE_CHECKING:
    from slipwise.calibration import Settings
    from slipwise.logs import LogOptions


GRADE_HELP = "Ground that falls by SLOPE towards DOWNHILL, both in degrees, 0 along x."


def _input_name(text: str) -> str:
    from slipwise.models.inputs import input_name_of

    return input_name_of(text, where="--input")


def optional(metavar: str, text: str, *names: str) -> Any:
    """Return an option that is left out by default; named by its parameter where no names are given."""
    return typer.Option(*names, metavar=metavar, show_default=False, help=text)


Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG...",
        show_default=False,
        help="Tidy CSV, CSV.gz or Parquet, or a ROS bag (.mcap, .db3, .bag, rosbag2 folder).",
    ),
]
Input = Annotated[
    str | None,
    typer.Option(
        "--input",
        parser=_input_name,
        metavar="[command|wheel]",
        show_default=False,
        help="Learn from commands or wheel speeds alone; default: commands where the log has them.",
    ),
]
ModelInput = Annotated[
    str | None,
    typer.Option(
        "--input",
        parser=_input_name,
        metavar="[command|wheel]",
        show_default=False,
        help="Of a model that answers from both: the input to use; default: commands.",
    ),
]
Basis = Annotated[
    str | None,
    optional("NAME", "Slip basis, such as edd-2 or odd-even-10; default auto, an average of several."),
]
SettingsFile = Annotated[Path | None, optional("FILE.toml", "Read settings from this file.", "--settings")]
Changes = Annotated[
    list[str] | None,
    optional(
        "KEY=VALUE", "Change one setting, such as prior.slip_fraction=0.5. Repeat it for others.", "--set"
    ),
]
Report = Annotated[Path | None, optional("FILE.html", "Write the HTML report to this file.")]
Json = Annotated[
    Path | None, optional("FILE", "Write the result as JSON; `-` prints it instead of tables.", "--json")
]
Folder = Annotated[
    Path | None, optional("DIR", "Write here, not into a new folder below `runs`.", "-o", "--output")
]
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", show_default=False, help="A model file (.yaml).")]
Force = Annotated[bool, typer.Option("--force", help="Use a model with a bad verdict, too.")]
Labels = Annotated[
    list[str] | None,
    optional(
        "NAME",
        "With --memory: the surface of all logs; repeat it to name that of each log; or a table (.csv) of "
        "surfaces by run and time from `slipwise terrain classify`. Default: the column `terrain`.",
        "--surface",
    ),
]
Duration = Annotated[float, typer.Option(metavar="SECONDS", help="How long to drive.")]
Seed = Annotated[int, typer.Option(metavar="N", help="Of the drive and of the pose noise.")]
Runs = Annotated[Path, typer.Option(metavar="DIR", help="Where run folders are kept.")]


#: What typer reads; all else is text.
_TYPES: dict[Kind, Any] = {
    Kind.topics: list[str],
    Kind.files: list[Path],
    Kind.positive: float,
    Kind.number: float,
}


def takes_log_options(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command with a parameter `log_options` one option for each of LOG_FIELDS.

    `--help` leaves them out, `--help-log` shows them.
    """
    unloaded = {"LogOptions": object}  # its module is heavy, and its type is never looked at
    signature = inspect.signature(command, eval_str=True, locals=unloaded)
    own = [parameter for parameter in signature.parameters.values() if parameter.name != "log_options"]
    names = [about.name for about in LOG_FIELDS]

    @functools.wraps(command)
    def wrapper(**given: Any) -> int:
        given.pop("help_log")
        chosen = {name: given.pop(name) for name in names}
        options = log_options(chosen, given.get("settings"), given.get("changes"))
        return command(log_options=options, **given)

    added = [*map(_parameter, LOG_FIELDS), _help_log(names)]
    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in (*own, *added)]
    wrapper.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    wrapper.__annotations__ = {p.name: p.annotation for p in parameters}
    return wrapper


def chosen_settings(file: Path | None, changes: Sequence[str] | None, basis: str | None = None) -> Settings:
    """Return the settings of a file, or the defaults, with what the command line gives before them.

    Raises:
        SettingsError: the file, a key, a value or the basis is wrong.
    """
    from slipwise.calibration.settings import load_settings, user_settings

    nested = _nested(changes or ()) | ({"basis": basis} if basis else {})
    settings = user_settings(nested, where="--set") if file is None else load_settings(file, nested)
    settings.bases()
    return settings


def _nested(changes: Sequence[str]) -> dict[str, Any]:
    """Return `KEY=VALUE` texts as nested dictionaries, as a settings file would give them."""
    import tomllib

    from slipwise.calibration.settings import merged
    from slipwise.errors import SettingsError

    result: dict[str, Any] = {}
    for change in changes:
        key, equals, text = change.partition("=")
        if not (key and equals and all(key.split("."))):
            advice = "write KEY=VALUE, such as prior.slip_fraction=0.5"
            raise SettingsError(f"'{change}' sets no key", where="--set", advice=advice)
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text  # a name without quotes
        for part in reversed(key.strip().split(".")):
            value = {part: value}
        result = merged(result, value)
    return result


def _parameter(about: About) -> inspect.Parameter:
    option = typer.Option(
        about.option, metavar=about.metavar, help=about.help, show_default=False, hidden=True
    )
    kind: Any = _TYPES.get(about.kind, str)
    return inspect.Parameter(
        about.name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[kind | None, option]
    )


def _help_log(names: Sequence[str]) -> inspect.Parameter:
    def show(ctx: typer.Context, asked: bool) -> None:
        if asked:
            show_options(ctx, names, "How a log is read (also settings, under [log])")
            raise typer.Exit

    text = f"Show the {len(names)} options for reading a log: topics, wheels, columns, clocks."
    option = typer.Option("--help-log", help=text, callback=show, is_eager=True, show_default=False)
    return inspect.Parameter(
        "help_log", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Annotated[bool, option]
    )


def log_options(given: dict[str, Any], file: Path | None, changes: Sequence[str] | None) -> LogOptions:
    """Return the options of the command line, and for the others those of the settings."""
    from slipwise.logs import LogOptions

    chosen = {
        about.name: _value(about, given[about.name]) for about in LOG_FIELDS if given[about.name] is not None
    }
    if file is None and not changes:
        return LogOptions.of(chosen)
    return chosen_settings(file, changes).log_options(**chosen)


def _value(about: About, text: Any) -> Any:
    """Return what the command line gives, as a settings file would have it."""
    if about.kind is Kind.names:
        return [part for part in text.split(",") if part]
    if about.kind is Kind.columns:
        from slipwise.logs.column_names import parse_columns

        return parse_columns(text)
    if about.kind is Kind.factors:
        return _factors(about.option, text)
    if about.kind is Kind.number_or_auto:
        with contextlib.suppress(ValueError):  # LogOptions refuses what is not auto
            return float(text)
    return text


def _factors(option: str, text: str) -> list[float]:
    from slipwise.errors import SettingsError

    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise SettingsError(
            f"'{text}' is not two factors, of speed and yaw rate",
            where=option,
            advice="such as 0.15,1 or -1,1",
        ) from None

# SPDX-License-Identifier: Apache-2.0
"""Options under their older names, read for one release with a note; and ports of options without a value."""

from __future__ import annotations

import contextlib
import itertools
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

from slipwise.errors import OlderNames, UnseenSpeed

#: Warnings of slipwise, which are shown as notes.
_OWN = (OlderNames, UnseenSpeed)

#: Ports of `slipwise live`, where an option of a server comes without one.
_PORTS = {"--web": "8088"}

#: By command: the option now, `--set KEY` for one that became a setting, `--set KEY=VALUE` for a flag;
#: nothing where it is gone.
RENAMED: dict[str, dict[str, str]] = {
    "calibrate": {
        "--estimator": "--set estimator",
        "--body-force": "--set body_force.frame",
        "--smooth": "--set smoothing.smooth=true",
        "--terrain": "--surface",
    },
    "evaluate": {"--terrain": "--surface"},
    "fleet": {"--vehicle": "--name"},
    "plan": {"--picture": "", "--no-picture": ""},
    "lattice": {"--picture": "", "--no-picture": ""},
    "live": {
        "--vehicle": "--name",
        "--basis": "--set basis",
        "--body-force": "--set body_force.frame",
        "--terrain": "--surface",
        "--terrain-topic": "--set live.surface_topic",
        "--override-topic": "--set live.override_topic",
        "--domain": "--set live.domain",
        "--network": "--set live.network=true",
        "--address": "--set live.address",
        "--apply": "--set live.apply.mode",
        "--host": "--set live.address",
        "--for": "--set live.duration",
    },
}


#: Options of reading a log that are gone, each with its value, and what holds now.
GONE = {
    "--most-unpacked": "512 MiB at most are unpacked; unpack a larger file first",
    "--most-fetched": "4096 MiB at most are fetched; copy a larger file first",
}


def with_new_names(arguments: Sequence[str]) -> list[str]:
    """Return the arguments with options under their present names, and note each older one on stderr."""
    command, *given = arguments
    renamed = RENAMED.get(command, {})
    result: list[str] = [command]
    rest: Iterator[str] = iter(given)
    for argument in rest:
        name, equals, value = argument.partition("=")
        if name == "--vehicle" and name in renamed:
            named = value if equals else next(rest, "")
            if _is_vehicle(named):  # it was the robot's name, too
                result += [name, named]
                continue
            rest, equals = itertools.chain([named] if named else [], rest), ""
        if name in GONE:
            print(f"note: {command} {name} is gone: {GONE[name]}", file=sys.stderr)
            _ = value if equals else next(rest, None)
        elif renamed.get(name) == "":
            print(f"note: {command} {name} is gone: no PNG is written any more", file=sys.stderr)
        elif name in renamed:
            print(f"note: {command} {name} is now {renamed[name]}", file=sys.stderr)
            result += _translated(renamed[name], value if equals else None, rest)
        elif command == "live" and result[-1] == "--memory" and argument.endswith((".yaml", ".yml")):
            print("note: live --memory MODEL is now --memory --model MODEL", file=sys.stderr)
            result += ["--model", argument]
        else:
            result.append(argument)
    return result


def _is_vehicle(value: str) -> bool:
    """Whether it is what a robot drives on, and not its name."""
    from slipwise.logs.vehicle_description import vehicle_names

    return value.endswith((".yaml", ".yml")) or value in vehicle_names()


def _translated(new: str, value: str | None, rest: Iterator[str]) -> list[str]:
    option, _, key = new.partition(" ")
    if "=" in key:
        return [option, key]
    value = next(rest, None) if value is None else value
    if value is None:
        return [option]  # the command says that a value is missing
    return [option, f"{key}={value}" if key else value]


@contextlib.contextmanager
def notes_of_warnings() -> Iterator[None]:
    """Note warnings of slipwise on stderr, one line each; other future warnings are of libraries."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)
        for own in _OWN:
            warnings.simplefilter("always", own)
        show, noted = warnings.showwarning, set[str]()

        def note(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            if issubclass(category, _OWN):
                if str(message) not in noted:  # a file is read for the log and for learning
                    print(f"note: {message}", file=sys.stderr)
                noted.add(str(message))
            else:
                show(message, category, *where, **more)

        warnings.showwarning = note
        yield


def with_ports(arguments: Sequence[str]) -> list[str]:
    """Return the arguments with the usual port behind every option of a server that has none."""
    result = []
    for argument, after in zip(arguments, [*arguments[1:], ""], strict=True):
        result.append(argument)
        if argument in _PORTS and not after.isdigit():
            result.append(_PORTS[argument])
    return result

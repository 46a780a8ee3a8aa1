# SPDX-License-Identifier: Apache-2.0
"""Parameter files of PX4 and ArduPilot rovers: learned values, with unit, deviation and source."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from slipwise.errors import ModelError
from slipwise.export.firmware_numbers import FirmwareNumbers
from slipwise.export.firmware_table import ARDUPILOT, PX4, FirmwareParameter, FirmwareTable
from slipwise.export.learned_number import LearnedNumber
from slipwise.export.measured_limits import Quantity
from slipwise.export.options import ExportOptions
from slipwise.export.origin import one_line
from slipwise.export.parameter_file import Value
from slipwise.models.model import Model

_REAL, _INTEGER = 9, 6  # MAV_PARAM_TYPE_REAL32 and _INT32, as QGroundControl writes them


@dataclass
class FirmwareFile:
    """The lines of a parameter file, its values, and why others are not written."""

    lines: list[str]
    values: dict[str, Value] = field(default_factory=dict)
    kept: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The file."""
        return "\n".join(self.lines) + "\n"


def px4(model: Model, options: ExportOptions, origin: Sequence[str]) -> FirmwareFile:
    """Return a parameter file as QGroundControl loads it: vehicle, component, name, value, type.

    Raises:
        ModelError: the version is not named.
        SettingsError: there is no table for it.
    """

    def line(parameter: FirmwareParameter, value: float) -> str:
        kind = _INTEGER if parameter.whole else _REAL
        return f"1\t1\t{parameter.name}\t{_digits(value, parameter)}\t{kind}"

    return _file(PX4, options.px4, FirmwareNumbers(model, options), line, origin)


def ardupilot(model: Model, options: ExportOptions, origin: Sequence[str]) -> FirmwareFile:
    """Return a parameter file as ArduPilot's ground stations load it: name, value.

    Raises:
        ModelError: the version is not named.
        SettingsError: there is no table for it.
    """

    def line(parameter: FirmwareParameter, value: float) -> str:
        return f"{parameter.name},{_digits(value, parameter)}"

    return _file(ARDUPILOT, options.ardupilot, FirmwareNumbers(model, options), line, origin)


def _file(
    table: FirmwareTable,
    version: str | None,
    numbers: FirmwareNumbers,
    line: Callable[[FirmwareParameter, float], str],
    origin: Sequence[str],
) -> FirmwareFile:
    limits = numbers.limits_asked
    if version is None:
        raise ModelError(
            f"the parameters of {table.firmware} have other names in each version",
            advice=f"add {table.option} {' or '.join(table.versions)}",
        )
    parameters = table.of_version(version)
    made = FirmwareFile(
        _comments([*origin, "", f"Parameters of {table.firmware} {version}, and of no other version."])
    )
    made.lines += _comments(["Read them before you load them: the vehicle drives by them."])
    if not limits:
        names = [parameter.name for parameter in parameters if parameter.limit]
        made.lines += _comments(
            ["", f"Limits are left as they are ({', '.join(names)}): --limits writes them."]
        )
    for parameter in parameters:
        if parameter.limit and not limits:
            continue
        found = numbers.answer(parameter.quantity)
        why = found if isinstance(found, str) else numbers.numbers.objection(found.number)
        if why or isinstance(found, str):
            made.kept[parameter.name] = one_line(why)
            made.lines += _comments(["", f"{parameter.name} is left as it is: {why}"])
            continue
        value = found.number.value * parameter.factor
        made.values[parameter.name] = value
        made.lines += ["", *_comments([_meaning(parameter, found, numbers)]), line(parameter, value)]
    return made


def _meaning(parameter: FirmwareParameter, found: Quantity, numbers: FirmwareNumbers) -> str:
    """Say the unit, how sure the number is, which parameters of the model it is from, and how."""
    scaled: LearnedNumber = found.number * parameter.factor
    sure = numbers.numbers.text(scaled) if numbers.numbers.std(scaled) > 0.0 else "not learned"
    names = ", ".join(numbers.numbers.parameters_of(found.number))
    return f"[{parameter.unit}] {sure}{f', from {names}' if names else ''}: {found.source}"


def _comments(lines: Sequence[str]) -> list[str]:
    return [f"# {one_line(line)}".rstrip() for line in lines]


def _digits(value: float, parameter: FirmwareParameter) -> str:
    return f"{round(value)}" if parameter.whole else f"{value:.6g}"

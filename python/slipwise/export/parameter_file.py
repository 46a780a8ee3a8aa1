# SPDX-License-Identifier: Apache-2.0
"""A ROS parameter file: entries with a comment each, written as YAML that both PyYAML and rcl read alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import yaml

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.origin import one_line
from slipwise.export.ros_tables import RosTable

_ROW = 15  # numbers on a line

Value = bool | float | str | list[bool] | list[float] | list[str]


@dataclass(frozen=True)
class Entry:
    """One parameter. `key` is its path below `ros__parameters`; a dot within a part is part of its name."""

    key: tuple[str, ...]
    value: Value
    meaning: str
    supposed: bool = False  # not learned: the other numbers are for a tool that is set up so

    @property
    def name(self) -> str:
        """The parameter's full name, as ROS spells it."""
        return ".".join(self.key)


@dataclass(frozen=True)
class Kept:
    """A parameter that is not written, so that its default stays; `why` stands in its place."""

    key: tuple[str, ...]
    why: str

    @property
    def name(self) -> str:
        """The parameter's full name, as ROS spells it."""
        return ".".join(self.key)


@dataclass(frozen=True)
class ParameterFile:
    """What one node is to be given."""

    node: str
    entries: Sequence[Entry | Kept]
    notes: Sequence[str] = ()  # about the whole file, one paragraph each

    def text(self, origin: Sequence[str]) -> str:
        """Return the file, with `origin` on top as a comment."""
        lines = _comment("\n".join(origin))
        for note in self.notes:
            lines += ["#", *_comment(note)]
        nothing = "" if any(isinstance(entry, Entry) for entry in self.entries) else " {}"
        lines += [f"{self.node}:", f"  ros__parameters:{nothing}"]
        open_parts: tuple[str, ...] = ()
        for entry in self.entries:
            *parents, last = entry.key
            if isinstance(entry, Kept):
                said = f"{entry.name} is not written, its default stays:\n{entry.why}"
                lines += _comment(said, _indent(len(parents)))
                continue
            for depth, part in enumerate(parents):
                if open_parts[: depth + 1] != tuple(parents[: depth + 1]):
                    lines.append(f"{_indent(depth)}{part}:")
            open_parts = tuple(parents)
            indent = _indent(len(parents))
            lines += _comment(entry.meaning, indent)
            lines.append(f"{indent}{last}: {_wrapped(entry.value, indent)}")
        return "\n".join(lines) + "\n"

    def values(self) -> dict[str, Value]:
        """Return the values by their full names."""
        return {entry.name: entry.value for entry in self.entries if isinstance(entry, Entry)}

    def kept(self) -> dict[str, str]:
        """Return why parameters are not written, by their full names."""
        kept = (entry for entry in self.entries if isinstance(entry, Kept))
        return {entry.name: " ".join(entry.why.split()) for entry in kept}


def stated(
    key: tuple[str, ...], number: LearnedNumber, meaning: str, numbers: LearnedNumbers
) -> Entry | Kept:
    """Return a learned number as an entry, or why it is none."""
    why = numbers.objection(number)
    return Kept(key, why) if why else Entry(key, number.value + 0.0, meaning)  # no -0.0


def for_release(
    entries: Sequence[Entry | Kept], table: RosTable, distro: str | None = None
) -> list[Entry | Kept]:
    """Return the entries that a release has; the others say that it does not.

    Raises:
        KeyError: the table does not know a parameter at all.
    """
    there, known = table.of_distro(distro), {f"{table.prefix}{each.name}" for each in table.parameters}
    for entry in entries:
        if entry.name not in known:
            raise KeyError(entry.name)
    return [
        entry
        if entry.name in there
        else Kept(entry.key, f"ROS 2 {(distro or '').capitalize()} has no such parameter")
        for entry in entries
    ]


def yaml_value(value: Value) -> str:
    """Return a value as YAML. A float always has a point: to ROS, `1` and `1.0` are of different types."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return _float_text(value)
    if isinstance(value, str):
        return str(yaml.safe_dump(value, default_style='"', width=math.inf)).rstrip("\n")
    return f"[{', '.join(yaml_value(item) for item in value)}]"


def _wrapped(value: Value, indent: str) -> str:
    """Return a value as YAML, a matrix of the EKF's state row by row."""
    if not isinstance(value, list) or len(value) <= _ROW:
        return yaml_value(value)
    texts = [yaml_value(item) for item in value]
    rows = (", ".join(texts[at : at + _ROW]) for at in range(0, len(texts), _ROW))
    return "[\n" + ",\n".join(f"{indent}  {row}" for row in rows) + f"\n{indent}]"


def _comment(text: str, indent: str = "") -> list[str]:
    """Return the lines of a text as lines of a comment, which no character of them can end."""
    return [f"{indent}# {one_line(line)}" for line in text.split("\n")]


def _float_text(value: float) -> str:
    if not math.isfinite(value):
        raise ModelError(
            f"a parameter would be {value}, which is not a number",
            advice="calibrate again, or restore the file",
        )
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}e{exponent}" if exponent else mantissa


def _indent(depth: int) -> str:
    return "  " * (depth + 2)

# SPDX-License-Identifier: Apache-2.0
"""Columns of a table under names of the user's own: which of them is which column of a tidy log."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from slipwise.errors import LogError, SettingsError

OPTION = "--columns"
_SHOWN = 20  # names of columns in an error
_DIGITS = 6  # a number of more is none of a column


def parse_columns(text: str) -> dict[str, str]:
    """Read `t=time,cmd_v=vx` or `t=0,cmd_v=1`: left the tidy name, right the name or number in the table.

    Raises:
        SettingsError: a part is no such pair, or a name stands on the left twice.
    """
    columns: dict[str, str] = {}
    for part in text.split(","):
        tidy, equal, own = (piece.strip() for piece in part.partition("="))
        if not (tidy and equal and own):
            advice = "write tidy=yours, such as t=time,cmd_v=vx or, by number, t=0,cmd_v=1"
            raise SettingsError(f"'{part.strip()}' is not a pair of names", where=OPTION, advice=advice)
        if tidy in columns:
            raise SettingsError(f"{tidy} is given twice", where=OPTION, advice="name one column for each")
        columns[tidy] = own
    return columns


def check_columns(columns: Mapping[str, str], known: Collection[str]) -> None:
    """Check that every name on the left is one that slipwise knows.

    Raises:
        SettingsError: it is not; the error lists those that are.
    """
    unknown = next((tidy for tidy in columns if tidy not in known), None)
    if unknown is not None:
        advice = f"write tidy=yours with one of {', '.join(known)}"
        raise SettingsError(f"{unknown} is not a column of a tidy log", where=OPTION, advice=advice)


def renamed(names: Sequence[str], columns: Mapping[str, str], path: Path) -> list[str]:
    """Return the names of a table's columns, those of the user's replaced by the tidy ones.

    What is no name in the table may be the number of a column, counted from 0. A column that had the tidy
    name already keeps its place under a name with an underscore before it.

    Raises:
        LogError: the table has no column of a name or number that was given, or one is given twice.
    """
    places = {tidy: place_of(own, names) for tidy, own in columns.items()}
    missing = next((tidy for tidy, place in places.items() if place is None), None)
    if missing is not None:
        raise LogError(
            f"there is no column {columns[missing]} (for {missing}={columns[missing]})",
            where=str(path),
            advice=f"give {OPTION} names out of {listed(names)}, or numbers from 0 to {len(names) - 1}",
        )
    if len(set(places.values())) < len(places):
        given = ",".join(f"{tidy}={own}" for tidy, own in columns.items())
        raise LogError(
            f"{OPTION} {given} names one column twice", where=str(path), advice="name each column once"
        )
    tidy_at = {place: tidy for tidy, place in places.items()}
    replaced = {tidy for tidy, own in columns.items() if tidy != own}
    return [tidy_at.get(place, f"_{name}" if name in replaced else name) for place, name in enumerate(names)]


def listed(names: Sequence[str]) -> str:
    """Return the first names of a table's columns."""
    return ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")


def place_of(own: str, names: Sequence[str]) -> int | None:
    """Return where a column stands that is named, or numbered from 0."""
    if own in names:
        return names.index(own)
    number = int(own) if own.isdecimal() and len(own) < _DIGITS else len(names)
    return number if number < len(names) else None

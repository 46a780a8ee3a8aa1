# SPDX-License-Identifier: Apache-2.0
"""Columns of a table under names of the user's own: which of them is which column of a tidy log."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from slipwise.errors import LogError, SettingsError

OPTION = "--columns"
_SHOWN = 20  # names of columns in an error


def parse_columns(text: str) -> dict[str, str]:
    """Read `t=time,cmd_v=vx`: on the left the tidy name, on the right the name in the table.

    Raises:
        SettingsError: a part is no such pair, or a name stands on the left twice.
    """
    columns: dict[str, str] = {}
    for part in text.split(","):
        tidy, equal, own = (piece.strip() for piece in part.partition("="))
        if not (tidy and equal and own):
            advice = "write tidy=yours, such as t=time,cmd_v=vx"
            raise SettingsError(f"'{part.strip()}' is no pair of names", where=OPTION, advice=advice)
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
        raise SettingsError(f"{unknown} is no column of a tidy log", where=OPTION, advice=advice)


def renamed(names: Sequence[str], columns: Mapping[str, str], path: Path) -> list[str]:
    """Return the names of a table's columns, those of the user's replaced by the tidy ones.

    A column that had the tidy name already keeps its place under a name with an underscore before it.

    Raises:
        LogError: the table has no column of a name that was given.
    """
    tidy_of = {own: tidy for tidy, own in columns.items()}
    missing = next((own for own in tidy_of if own not in names), None)
    if missing is not None:
        found = ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")
        raise LogError(
            f"there is no column {missing} (for {tidy_of[missing]}={missing})",
            where=str(path),
            advice=f"give {OPTION} names out of {found}",
        )
    replaced = {tidy for tidy, own in columns.items() if tidy != own}
    return [tidy_of.get(name, f"_{name}" if name in replaced else name) for name in names]

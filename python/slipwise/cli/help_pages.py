# SPDX-License-Identifier: Apache-2.0
"""What `--help` shows: commands in groups, and options of reading a log on a page of their own."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import typer
from typer.core import TyperGroup

#: The commands by what they are for, in the order of use; those of packages beside slipwise come last.
GROUPS = {
    "Learn": ("inspect", "doctor", "calibrate", "evaluate", "show", "compare", "excite"),
    "Use": ("export", "live", "plan", "lattice"),
    "Data": ("convert", "score", "fleet", "surfaces", "terrain"),
    "See it": ("demo", "simulate", "reproduce"),
}


class GroupedCommands(TyperGroup):
    """Lists its commands below the headings of GROUPS."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """Write the commands of every group that has some, in columns of one width."""
        grouped = {name for names in GROUPS.values() for name in names}
        groups = GROUPS | {"More": tuple(name for name in self.commands if name not in grouped)}
        width = max(map(len, self.commands))
        room = formatter.width - width - 6
        for heading, names in groups.items():
            rows = [
                (name.ljust(width), self.commands[name].get_short_help_str(room))
                for name in names
                if name in self.commands
            ]
            if rows:
                with formatter.section(heading):
                    formatter.write_dl(rows)


def show_options(ctx: typer.Context, names: Collection[str], heading: str) -> None:
    """Print the options of a command that its `--help` leaves out."""
    formatter = ctx.make_formatter()
    records = []
    for option in ctx.command.params:
        if option.name in names:
            option.hidden = False  # type: ignore[attr-defined]
            records.append(option.get_help_record(ctx))
            option.hidden = True  # type: ignore[attr-defined]
    with formatter.section(heading):
        formatter.write_dl([record for record in records if record is not None])
    print(formatter.getvalue().rstrip("\n"))

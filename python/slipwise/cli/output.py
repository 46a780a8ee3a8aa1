# SPDX-License-Identifier: Apache-2.0
"""What a command prints: lines and tables for people, or one JSON document for machines."""

from __future__ import annotations

import json
import math
import shutil
import sys
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from slipwise.cli.errors import printable, silence_stdout
from slipwise.errors import OutputError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

STDOUT = "-"
UNWRAPPED = 10_000  # characters; no table is wider
WIDTH_OF_A_PIPE = 160  # characters; nothing is cut where a file or a pipe takes the tables


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    head: str
    right: bool = False  # numbers are aligned to the right, and never wrapped
    whole: bool = False  # never wrapped
    spare: int = 0  # a table that is too wide goes without its columns of the highest number first; 0: never


@dataclass
class Output:
    """Where a command's results go; with JSON on stdout, nothing else is printed there."""

    json_file: Path | None
    _console: Console | None = field(default=None, init=False)

    @property
    def for_people(self) -> bool:
        """Whether lines and tables are shown."""
        return str(self.json_file) != STDOUT

    @property
    def written_file(self) -> Path | None:
        """The JSON file to write, None where there is none."""
        return self.json_file if self.for_people else None

    def line(self, text: str = "", *, label: str = "", colour: str = "") -> None:
        """Print one line, after a label in a colour where a terminal takes it; long ones go on below it.

        Where a file or a pipe takes the line, it stays one line without a colour.
        """
        if not self.for_people:
            return
        shown = " ".join(part for part in (printable(label), printable(text)) if part)
        console = self._out()
        if not console.is_terminal:
            _print(shown)
            return
        from rich.text import Text

        wrapped = Text(wrapped_text(shown, console.width))
        if colour:
            wrapped.stylize(f"bold {colour}", 0, len(printable(label)))
        with console.capture() as captured:
            console.print(wrapped, soft_wrap=True)
        _print(captured.get().removesuffix("\n"))

    def table(
        self, title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]], *, caption: str = ""
    ) -> None:
        """Print a table, without spare columns where it would be too wide."""
        if not self.for_people:
            return
        console = self._out()
        shown = list(range(len(columns)))
        made = _table(columns, rows, shown, narrow=False)
        while _width(console, made) > console.width:
            made = _table(columns, rows, shown, narrow=True)
            most = max(columns[k].spare for k in shown)
            if _width(console, made) <= console.width or most == 0:
                break
            shown = [k for k in shown if columns[k].spare < most]
        missing = dict.fromkeys(column.head for k, column in enumerate(columns) if k not in shown)
        if missing:
            caption += f" Too narrow for {', '.join(missing)}: a wider terminal or --json has them."
        made.title, made.caption = title, caption.strip() or None
        with console.capture() as captured:  # rich itself would end the process on a closed pipe
            console.print(made)
        _print(captured.get())

    def document(self, content: Mapping[str, Any]) -> None:
        """Write the JSON document to where `--json` says.

        Raises:
            OutputError: the file cannot be written.
        """
        if self.json_file is None:
            return
        if self.for_people:
            from slipwise.files import write_text_whole

            write_text_whole(self.json_file, to_json(content))
            return
        try:
            sys.stdout.write(to_json(content))
            sys.stdout.flush()
        except BrokenPipeError:
            silence_stdout()
        except OSError as error:
            raise OutputError(f"cannot write: {error.strerror}", where="stdout") from error

    def _out(self) -> Console:
        if self._console is None:
            from rich.console import Console

            width = (
                None
                if sys.stdout.isatty()
                else max(WIDTH_OF_A_PIPE, shutil.get_terminal_size((0, 0)).columns)
            )
            self._console = Console(width=width, markup=False, emoji=False, highlight=False)
        return self._console


def _table(
    columns: Sequence[Column], rows: Sequence[Sequence[str]], shown: Sequence[int], *, narrow: bool
) -> Table:
    """Return the table of the columns that are shown, with less space between them where it is narrow."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, title_justify="left", caption_justify="left", collapse_padding=narrow)
    for k in shown:
        column, cells = columns[k], [printable(row[k]) for row in rows]
        justify: Literal["left", "right"] = "right" if column.right else "left"
        table.add_column(
            printable(column.head),
            justify=justify,
            no_wrap=column.whole,
            overflow="fold",
            min_width=max(map(len, cells), default=0) if column.right else None,
        )
    for row in rows:
        table.add_row(*(printable(row[k]) for k in shown))
    return table


def _width(console: Console, table: Table) -> int:
    """How wide the table is where nothing is wrapped."""
    return int(console.measure(table, options=console.options.update(max_width=UNWRAPPED)).maximum)


def wrapped_text(text: str, width: int) -> str:
    """Return a line broken between words, so that no part is wider; what goes on keeps the indentation."""
    indent = " " * (len(text) - len(text.lstrip()))
    broken = textwrap.wrap(
        text.strip(),
        max(width, 20),
        initial_indent=indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(broken)


def _print(text: str) -> None:
    try:
        print(text, flush=True)
    except BrokenPipeError:
        silence_stdout()


def to_json(content: Mapping[str, Any]) -> str:
    """Return JSON that every reader takes: what is not a finite number becomes null."""
    return json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, Path):
        return str(value)
    return value

# SPDX-License-Identifier: Apache-2.0
"""How the text of a table is laid out: its comments, the names of its columns, what separates its cells."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.errors import LogError

if TYPE_CHECKING:
    import pyarrow as pa

_START = 1 << 20  # bytes in which the first row is looked for
_LINE = re.compile(rb"([^\r\n]*)(\r\n|\n|\r|\Z)")
_COMMENT = re.compile(rb"(?m)(?:^|(?<=\r))[ \t]*#[^\r\n]*")
_AROUND = {",": None, "\t": rb"[ ]*\t[ ]*", ";": rb"[ \t]*;[ \t]*", " ": rb"[ \t]+"}  # a cell's end
_ENDS = re.compile(rb"(?m)^[ \t]+|[ \t]+(?=\r|\n|\Z)")
_COMMAS = "save it as plain CSV: commas between cells, points in numbers"


@dataclass(frozen=True)
class TableText:
    """The rows of a table as plain CSV, and what stands above them."""

    content: pa.Buffer
    names: list[str]  # of the columns; their numbers, from 0, where the table has no names
    named: bool
    first_line: int  # number of the first row, in the user's eyes
    comment: str  # the last line above the rows that starts with #, without it


@dataclass(frozen=True)
class _Line:
    number: int
    start: int  # bytes
    end: int  # with its line end
    text: str


def table_text(content: pa.Buffer, path: Path) -> TableText:
    """Find the names and the rows of a table. Lines that start with # are comments.

    Names stand in the first other line. Where that is a row of numbers they stand in the comment above it, if
    that names each column; else the table has no names.

    Raises:
        LogError: this is no text, a name stands there twice, or cells are separated by something else.
    """
    import pyarrow as pa

    start = content[:_START].to_pybytes()
    if b"\0" in start:
        raise LogError("not a text file", where=str(path), advice="give a CSV, Parquet or bag file")
    comment, first = _above(start, path)
    if first is None:  # nothing but comments
        first = _Line(1, len(start), len(start), comment)
    separator = _separator(first.text)
    cells = _cells(first.text, separator, path)
    named = not (len(cells) > 1 and all(map(_is_number, cells)))
    names = cells
    if not named:
        commented = _cells(comment, separator, path)
        named = len(commented) == len(cells) == len({*commented} - {""})
        named = named and not any(map(_is_number, commented))
        names = commented if named else [str(number) for number in range(len(cells))]
        begin, line = first.start, first.number
    else:
        begin, line = first.end, first.number + 1
    refuse_twice(names, f"{path}, line {first.number}")
    rows = content[begin:] if begin < len(content) else pa.py_buffer(b"\n")  # Arrow reads no empty text
    return TableText(_plain(rows, separator, path), names, named, line, comment)


def refuse_twice(names: list[str], where: str) -> None:
    """Raise LogError where two columns have one name."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise LogError(f"column {twice[0]} is there twice", where=where, advice="rename one of them")


def _above(start: bytes, path: Path) -> tuple[str, _Line | None]:
    """Return the last comment above the rows, and the first line that is none."""
    comment = ""
    for number, found in enumerate(_LINE.finditer(start), start=1):
        try:
            text = found[1].decode("utf-8-sig" if number == 1 else "utf-8").strip()
        except UnicodeDecodeError as error:
            raise LogError(
                "not a text file", where=str(path), advice="give a CSV, Parquet or bag file"
            ) from error
        if text.startswith("#"):
            comment = text.lstrip("#").strip()
        elif text:
            return comment, _Line(number, found.start(), found.end(), text)
    return comment, None


def _separator(line: str) -> str:
    """Return what separates the cells of a line."""
    return next((mark for mark in (",", "\t", ";") if mark in line), " ")


def _cells(line: str, separator: str, path: Path) -> list[str]:
    """Return the cells of a line of names or numbers."""
    if separator == " ":
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]
    except csv.Error as error:
        raise LogError(
            "not a text file", where=str(path), advice="give a CSV, Parquet or bag file"
        ) from error


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _plain(content: pa.Buffer, separator: str, path: Path) -> pa.Buffer:
    """Return the rows without comments, their cells separated by commas."""
    import pyarrow as pa

    around = _AROUND[separator]
    view = memoryview(content)
    commented = re.search(b"#", view) is not None and _COMMENT.search(view) is not None
    if around is None and not commented:
        return content
    data = _COMMENT.sub(b"", view) if commented else bytes(view)
    if around is None:
        return pa.py_buffer(data)
    if b"," in data:
        raise LogError("the columns are not separated by commas", where=str(path), advice=_COMMAS)
    if separator == " ":
        data = _ENDS.sub(b"", data)
    return pa.py_buffer(re.sub(around, b",", data))

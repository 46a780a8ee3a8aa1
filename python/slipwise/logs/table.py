# SPDX-License-Identifier: Apache-2.0
"""Reads a table file (CSV, CSV.gz, Parquet) into named columns."""

from __future__ import annotations

import csv
import hashlib
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.logs.column_names import renamed
from slipwise.logs.left_out import Tally
from slipwise.logs.log import ABSURD, Floats

if TYPE_CHECKING:
    import pyarrow as pa

EMPTY_CELLS = ["", "NA", "N/A", "#N/A", "null", "NULL", "None"]  # no measurement; "nan" is a faulty one


@dataclass(frozen=True)
class Table:
    """The columns of a table file and where they came from."""

    path: Path
    format: str
    sha256: str
    arrow: pa.Table
    first_line: int  # number of the first row in the user's eyes

    @property
    def names(self) -> list[str]:
        """Return the column names."""
        return list(self.arrow.column_names)

    def __len__(self) -> int:
        return int(self.arrow.num_rows)

    def place(self, row: int) -> str:
        """Say where row `row` (from 0) is."""
        unit = "row" if self.format == "parquet" else "line"
        return f"{self.path.name}, {unit} {row + self.first_line}"

    def numbers(self, name: str, tally: Tally) -> Floats:
        """Return a column as numbers, NaN where the cell is empty; counts those that are NaN or infinite.

        Raises:
            LogError: the column holds something else.
        """
        column = self.arrow.column(name)
        try:
            values = np.asarray(column.cast("float64").to_numpy(), dtype=np.float64)
        except (ValueError, NotImplementedError) as error:
            advice = f"column {name} must hold numbers"
            raise LogError(f"not a number in column {name}", where=str(self.path), advice=advice) from error
        finite = np.abs(values) < ABSURD  # false for NaN
        if finite.sum() < len(values) - column.null_count:
            wrong = np.asarray(column.is_valid().to_numpy(), dtype=bool) & ~finite
            reason = f"cells of {name} that are not finite, or absurdly large"
            tally.add("non-finite", reason, count=int(wrong.sum()), where=self.place(int(np.argmax(wrong))))
            values = np.where(finite, values, np.nan)
        return values

    def codes(self, name: str) -> tuple[NDArray[np.int64], list[str]]:
        """Return a column of names as codes [N] and the names, numbered as they first appear."""
        column = self.arrow.column(name).combine_chunks()
        encoded = column if _is_dictionary(column) else column.dictionary_encode()
        filled = encoded.indices.fill_null(-1)
        codes = np.asarray(filled.to_numpy(zero_copy_only=False), dtype=np.int64)
        names = ["" if value is None else str(value) for value in encoded.dictionary.to_pylist()]
        if (codes < 0).any():
            codes, names = np.where(codes < 0, len(names), codes), [*names, ""]
        return codes, names

    def other(self, name: str) -> NDArray[Any]:
        """Return any column as it is: numbers (NaN where empty), or objects for text."""
        column = self.arrow.column(name).combine_chunks()
        if _is_dictionary(column):
            names = np.array([*column.dictionary.to_pylist(), None], dtype=object)
            indices = np.asarray(column.indices.fill_null(len(names) - 1).to_numpy(zero_copy_only=False))
            return np.asarray(names[indices])
        return np.asarray(column.to_numpy(zero_copy_only=False))


def read_csv(
    path: Path, *, numeric: Collection[str], text: Collection[str], columns: Mapping[str, str], tally: Tally
) -> Table:
    """Read a CSV file, compressed with gzip or not, by what its first bytes say.

    Args:
        path: the file.
        numeric: names of columns that must hold numbers, where they exist.
        text: names of columns to be read as text, where they exist.
        columns: names that the table has, by the names to read them as.
        tally: counts the rows that cannot be read.

    Raises:
        LogError: the file is cut off or is not such a table.
    """
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    raw = pa.memory_map(str(path)).read_buffer()
    sha256 = hashlib.sha256(raw).hexdigest()
    packed = raw[:2].to_pybytes() == b"\x1f\x8b"
    content = _unpack(raw, path) if packed else raw
    header, skip = _header(content, path)
    header = renamed(header, columns, path)
    types: dict[str, Any] = {name: pa.float64() for name in header if name in numeric}
    types |= {name: pa.dictionary(pa.int32(), pa.string()) for name in header if name in text}
    broken: list[int] = []

    def skip_row(row: Any) -> str:
        broken.append(row.actual_columns)
        return "skip"

    convert = arrow_csv.ConvertOptions(
        column_types=types, null_values=EMPTY_CELLS, strings_can_be_null=True, auto_dict_encode=True
    )
    parse = arrow_csv.ParseOptions(invalid_row_handler=skip_row)
    read = arrow_csv.ReadOptions(column_names=header, skip_rows=skip)
    try:
        arrow = arrow_csv.read_csv(
            pa.BufferReader(content), read_options=read, parse_options=parse, convert_options=convert
        )
    except pa.ArrowInvalid as error:
        advice = "every cell of a measurement must be a number or empty"
        raise LogError(
            f"not a tidy table: {_named_column(error, header)}", where=str(path), advice=advice
        ) from error
    reason = f"rows that do not have {len(header)} cells"
    tally.add("broken-row", reason, count=len(broken), where=path.name)
    return Table(path, "csv.gz" if packed else "csv", sha256, arrow.unify_dictionaries(), first_line=skip + 1)


def read_parquet(path: Path, *, columns: Mapping[str, str]) -> Table:
    """Read a Parquet file; `columns` are names that the table has, by the names to read them as.

    Raises:
        LogError: the file is cut off or is not Parquet.
    """
    import pyarrow as pa
    import pyarrow.parquet as parquet

    raw = pa.memory_map(str(path)).read_buffer()
    try:
        arrow = parquet.read_table(pa.BufferReader(raw))
    except (pa.ArrowInvalid, pa.ArrowException, OSError) as error:
        raise LogError(
            f"not a readable Parquet file: {error}", where=str(path), advice="copy it again"
        ) from error
    arrow = arrow.rename_columns(renamed(arrow.column_names, columns, path))
    return Table(path, "parquet", hashlib.sha256(raw).hexdigest(), arrow.unify_dictionaries(), first_line=1)


def _unpack(raw: pa.Buffer, path: Path) -> pa.Buffer:
    import pyarrow as pa

    try:
        with pa.CompressedInputStream(pa.BufferReader(raw), "gzip") as stream:
            return stream.read_buffer()
    except OSError as error:
        raise LogError(
            "the gzip file is cut off or damaged", where=str(path), advice="copy it again"
        ) from error


def _header(content: pa.Buffer, path: Path) -> tuple[list[str], int]:
    """Return the column names and the number of lines that they take."""
    start = content[: 1 << 16].to_pybytes()
    if b"\0" in start:
        raise LogError("not a text file", where=str(path), advice="give a CSV, Parquet or bag file")
    try:
        line = start.split(b"\n", 1)[0].decode("utf-8-sig").strip()
    except UnicodeDecodeError as error:
        raise LogError(
            "not a text file", where=str(path), advice="give a CSV, Parquet or bag file"
        ) from error
    names = [name.strip() for name in next(csv.reader([line]), [])]
    if len(names) < 2 and (";" in line or "\t" in line):
        raise LogError(
            "the columns are not separated by commas", where=str(path), advice="save it as plain CSV"
        )
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise LogError(
            f"column {twice[0]} is there twice", where=f"{path}, line 1", advice="rename one of them"
        )
    return names, 1


def _named_column(error: Exception, header: list[str]) -> str:
    """Return the message with the column's name in place of its number."""
    return re.sub(r"CSV column #(\d+)", lambda found: f"column {header[int(found[1])]}", str(error))


def _is_dictionary(column: pa.Array) -> bool:
    import pyarrow as pa

    return isinstance(column, pa.DictionaryArray)

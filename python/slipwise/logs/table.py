# SPDX-License-Identifier: Apache-2.0
"""Reads a table file (CSV, CSV.gz, Parquet) into named columns."""

from __future__ import annotations

import contextlib
import hashlib
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.logs.column_names import renamed
from slipwise.logs.left_out import Tally
from slipwise.logs.log import ABSURD, Floats
from slipwise.logs.table_text import TableText, refuse_twice, table_text
from slipwise.logs.unpacking import most_bytes, too_large

if TYPE_CHECKING:
    import pyarrow as pa

EMPTY_CELLS = ["", "NA", "N/A", "#N/A", "null", "NULL", "None"]  # no measurement; "nan" is a faulty one
# The same behind spaces that align columns; Arrow compares whole cells.
_PADDED = [" " * spaces + cell for spaces in range(33) for cell in EMPTY_CELLS]
_BLOCK = 1 << 20  # bytes


class Columns(Protocol):
    """Rows of a tidy log by their columns: of a file, or of a line that just came."""

    @property
    def path(self) -> Path:
        """Where they come from."""

    @property
    def names(self) -> list[str]:
        """The column names."""

    @property
    def named(self) -> bool:
        """False: the names are numbers, from 0."""

    @property
    def comment(self) -> str:
        """The last line above the rows that is a comment."""

    def __len__(self) -> int: ...

    def numbers(self, name: str, tally: Tally) -> Floats:
        """Return a column as numbers, NaN where the cell is empty or not finite, which is counted."""


@dataclass(frozen=True)
class Table:
    """The columns of a table file and where they came from."""

    path: Path
    format: str
    sha256: str
    arrow: pa.Table
    first_line: int  # number of the first row in the user's eyes
    named: bool = True  # false: the names are numbers, from 0
    comment: str = ""  # the last line above the rows that is a comment

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
        advice = f"column {name} must hold {'seconds as numbers' if name == 't' else 'numbers'}"
        with _column_errors(f"not a number in column {name}", self.path, advice):
            values = _floats(column.cast("float64", safe=False))
        finite = np.abs(values) < ABSURD  # false for NaN
        if finite.sum() < len(values) - column.null_count:
            wrong = np.asarray(column.is_valid().to_numpy(), dtype=bool) & ~finite
            reason = f"cells of {name} that are not finite, or absurdly large"
            tally.add("non-finite", reason, count=int(wrong.sum()), where=self.place(int(np.argmax(wrong))))
            values = np.where(finite, values, np.nan)
        return values

    def codes(self, name: str) -> tuple[NDArray[np.int64], list[str]]:
        """Return a column of names as codes [N] and the names, numbered as they first appear."""
        with _column_errors(f"not names in column {name}", self.path, "write each as UTF-8 text or a number"):
            column = self.arrow.column(name).combine_chunks()
            encoded = column if _is_dictionary(column) else column.dictionary_encode()
            numbers = _floats(encoded.indices.cast("float64"))
            codes = np.where(np.isnan(numbers), -1, numbers).astype(np.int64)
            names = ["" if value is None else str(value) for value in encoded.dictionary.to_pylist()]
        if (codes < 0).any():
            codes, names = np.where(codes < 0, len(names), codes), [*names, ""]
        return codes, names

    def other(self, name: str) -> NDArray[Any]:
        """Return any column as it is: numbers (NaN where empty), or objects for text.

        Raises:
            LogError: its values cannot be read.
        """
        with _column_errors(f"column {name} cannot be read", self.path, "leave it out, or write it as text"):
            column = self.arrow.column(name).combine_chunks()
            if not _is_dictionary(column):
                return np.asarray(column.to_numpy(zero_copy_only=False))
            names = np.array([*column.dictionary.to_pylist(), None], dtype=object)
            indices = np.asarray(column.indices.fill_null(len(names) - 1).to_numpy(zero_copy_only=False))
            return np.asarray(names[indices])


def is_parquet(path: Path) -> bool:
    """Say whether a file is Parquet, by its first bytes."""
    with path.open("rb") as file:
        return file.read(4) == b"PAR1"


def read_table(
    path: Path, *, numeric: Collection[str], text: Collection[str], columns: Mapping[str, str], tally: Tally
) -> Table:
    """Read a table by what its first bytes say: Parquet, or a CSV file as `read_csv` does.

    Raises:
        LogError: the file is cut off or is not such a table.
    """
    if is_parquet(path):
        return read_parquet(path, columns=columns)
    return read_csv(path, numeric=numeric, text=text, columns=columns, tally=tally)


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

    raw = _mapped(path)
    sha256 = hashlib.sha256(raw).hexdigest()
    packed = raw[:2].to_pybytes() == b"\x1f\x8b"
    content = _unpack(raw, path) if packed else raw
    lines = table_text(content, path)
    header = renamed(lines.names, columns, path)
    types: dict[str, Any] = {name: pa.float64() for name in header if name in numeric}
    types |= {name: pa.dictionary(pa.int32(), pa.string()) for name in header if name in text}
    broken: list[int] = []

    def skip_row(row: Any) -> str:
        broken.append(row.actual_columns)
        return "skip"

    convert = arrow_csv.ConvertOptions(
        column_types=types, null_values=_PADDED, strings_can_be_null=True, auto_dict_encode=True
    )
    parse = arrow_csv.ParseOptions(invalid_row_handler=skip_row)
    # A thread of Arrow that still holds `skip_row` when Python ends, as after an error, would abort it.
    read = arrow_csv.ReadOptions(column_names=header, use_threads=False)
    rows = _as_utf8(lines, tally, path.name)
    try:
        arrow = arrow_csv.read_csv(
            pa.BufferReader(rows), read_options=read, parse_options=parse, convert_options=convert
        )
    except pa.ArrowException as error:
        advice = "every cell of a measurement must be a number or empty, and text UTF-8"
        raise LogError(
            f"not a tidy table: {_named_column(error, header)}", where=str(path), advice=advice
        ) from error
    reason = f"rows that do not have {len(header)} cells"
    tally.add("broken-row", reason, count=len(broken), where=path.name)
    return Table(
        path,
        "csv.gz" if packed else "csv",
        sha256,
        arrow.unify_dictionaries(),
        lines.first_line,
        lines.named,
        lines.comment,
    )


def read_parquet(path: Path, *, columns: Mapping[str, str]) -> Table:
    """Read a Parquet file; `columns` are names that the table has, by the names to read them as.

    Raises:
        LogError: the file is cut off, is not Parquet, or unpacks to more than is allowed.
    """
    import pyarrow as pa
    import pyarrow.parquet as parquet

    raw = _mapped(path)
    try:
        file = parquet.ParquetFile(pa.BufferReader(raw))
        refuse_twice(file.schema_arrow.names, str(path))
        groups = [file.metadata.row_group(i).total_byte_size for i in range(file.num_row_groups)]
        left, batches = most_bytes(), []
        if sum(groups) > left:
            raise too_large("the table", str(path))
        for batch in file.iter_batches(use_threads=False):
            left -= batch.nbytes
            if left < 0:
                raise too_large("the table", str(path))
            batches.append(batch)
        arrow = pa.Table.from_batches(batches, schema=file.schema_arrow).unify_dictionaries()
    except (pa.ArrowException, OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split())[:200]
        raise LogError(
            f"not a readable Parquet file: {reason}", where=str(path), advice="copy or write it again"
        ) from error
    arrow = arrow.rename_columns(renamed(arrow.column_names, columns, path))
    return Table(path, "parquet", hashlib.sha256(raw).hexdigest(), arrow.unify_dictionaries(), first_line=1)


def _mapped(path: Path) -> pa.Buffer:
    import pyarrow as pa

    return pa.memory_map(str(path)).read_buffer()


def _as_utf8(lines: TableText, tally: Tally, name: str) -> pa.Buffer:
    """Return the rows with a mark in place of each byte that is no UTF-8; Arrow skips such rows."""
    import pyarrow as pa

    content = lines.content
    view = memoryview(content)
    blocks = (view[at : at + _BLOCK] for at in range(0, len(view), _BLOCK))
    if all(bytes(block).isascii() for block in blocks):
        return content
    data = bytes(view)
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        text = data.decode("utf-8", errors="replace")
        place = f"{name}, line {data[: error.start].count(10) + lines.first_line}"
        tally.add("bad-text", "bytes that are not UTF-8", count=text.count("\ufffd"), where=place)
        return pa.py_buffer(text.encode())
    return content


def _unpack(raw: pa.Buffer, path: Path) -> pa.Buffer:
    import pyarrow as pa

    most = most_bytes()
    try:
        with pa.CompressedInputStream(pa.BufferReader(raw), "gzip") as stream:
            content = stream.read_buffer(most + 1)
    except OSError as error:
        raise LogError(
            "the gzip file is cut off or damaged", where=str(path), advice="copy it again"
        ) from error
    if content.size > most:
        raise too_large("the table", str(path))
    return content


@contextlib.contextmanager
def _column_errors(what: str, path: Path, advice: str) -> Iterator[None]:
    """Turn whatever Arrow raises about the values of a column into a LogError."""
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, ValueError, TypeError, KeyError, NotImplementedError, OverflowError) as error:
        raise LogError(what, where=str(path), advice=advice) from error


def _floats(column: pa.Array | pa.ChunkedArray) -> Floats:
    """Return numbers, NaN where there is none; `to_numpy` of Arrow would import pandas, which takes 0.3 s."""
    import pyarrow as pa

    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    if not len(whole):
        return np.zeros(0)
    tensor = pa.RecordBatch.from_arrays([whole], names=["values"]).to_tensor(null_to_nan=True)
    return np.asarray(tensor.to_numpy()[:, 0], dtype=np.float64)


def _named_column(error: Exception, header: list[str]) -> str:
    """Return the message with the column's name in place of its number."""
    return re.sub(r"CSV column #(\d+)", lambda found: f"column {header[int(found[1])]}", str(error))


def _is_dictionary(column: pa.Array) -> bool:
    import pyarrow as pa

    return isinstance(column, pa.DictionaryArray)

# SPDX-License-Identifier: Apache-2.0
"""Reads and writes PGM images, plain and binary, as maps are kept in them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import PlanningError
from slipwise.files import write_whole

MOST_PIXELS = 100_000_000
_SPACE = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"(P[25])" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,5})\s")


def read_pgm(path: Path) -> NDArray[np.float64]:
    """Return an image's grey values, 0 (black) to 1 (white), [rows, columns], the top row first.

    Raises:
        PlanningError: the file cannot be read or is no PGM image.
    """
    try:
        data = path.read_bytes()
    except OSError as problem:
        raise PlanningError(
            f"cannot read the map's image: {problem.strerror}", where=str(path), advice="check the path"
        ) from problem
    header = _HEADER.match(data)
    if header is None:
        raise _fault(path, "is no PGM image", "save the map as PGM")
    columns, rows, most = (int(number) for number in header.groups()[1:])
    if not (0 < columns * rows <= MOST_PIXELS and 0 < most < 65536):
        raise _fault(path, f"claims {columns} x {rows} pixels up to {most}", "save the map again")
    body = data[header.end() :]
    if header[1] == b"P2":
        try:
            values = np.array(body.split(), dtype=np.int64)
        except (ValueError, OverflowError) as problem:
            raise _fault(path, "holds what is no number", "save the map again") from problem
    else:
        kind = np.dtype(np.uint8 if most < 256 else ">u2")
        values = np.frombuffer(body[: len(body) - len(body) % kind.itemsize], dtype=kind)
    if len(values) < columns * rows:
        raise _fault(path, f"is cut off: {len(values)} of {columns * rows} pixels", "copy the file again")
    return np.asarray(values[: columns * rows].reshape(rows, columns) / most, dtype=np.float64)


def write_pgm(path: Path, grey: NDArray[np.float64]) -> Path:
    """Write grey values, 0 to 1, [rows, columns], the top row first; return the path.

    Raises:
        OutputError: the file cannot be written.
    """
    rows, columns = grey.shape
    pixels = np.clip(np.rint(grey * 255.0), 0, 255).astype(np.uint8)
    data = f"P5\n{columns} {rows}\n255\n".encode() + pixels.tobytes()

    def write(target: Path) -> None:
        target.write_bytes(data)

    write_whole(path, write)
    return path


def _fault(path: Path, what: str, advice: str) -> PlanningError:
    return PlanningError(f"the map's image {what}", where=str(path), advice=advice)

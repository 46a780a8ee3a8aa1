# SPDX-License-Identifier: Apache-2.0
"""Reads and writes PGM images, plain and binary, as maps are kept in them."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import PlanningError
from slipwise.files import read_whole, write_whole

MOST_PIXELS = 25_000_000  # such as 250 m x 250 m in cells of 5 cm; planning takes about 40 bytes for each
_BYTES_PER_PIXEL = 6  # at most: five digits and a space
_SPACE = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"(P[25])" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,5})\s")

Levels = NDArray[np.uint16]


def read_pgm(path: Path, *, most_pixels: int = MOST_PIXELS) -> NDArray[np.float64]:
    """Return an image's grey values, 0 (black) to 1 (white), [rows, columns], the top row first.

    Raises:
        PlanningError: the file cannot be read, is no PGM image, or has more pixels than allowed.
    """
    levels, white = read_levels(path, most_pixels=most_pixels)
    return np.asarray(levels / white, dtype=np.float64)


def read_levels(path: Path, *, most_pixels: int = MOST_PIXELS) -> tuple[Levels, int]:
    """Return an image's grey levels as stored, [rows, columns], and which is white; see `read_pgm`."""
    most = most_pixels * _BYTES_PER_PIXEL + 4096
    data = read_whole(path, most=most, error=PlanningError, what="the map's image")
    header = _HEADER.match(data)
    if header is None:
        raise _fault(path, "is no PGM image", "save the map as PGM")
    columns, rows, white = (int(number) for number in header.groups()[1:])
    if not (columns * rows > 0 and 0 < white < 65536):
        raise _fault(path, f"claims {columns} x {rows} pixels up to {white}", "save the map again")
    if columns * rows > most_pixels:
        advice = "cut it to where the robot drives, or allow more: most_cells, or --most-cells"
        raise _fault(path, f"has {columns} x {rows} pixels, more than {most_pixels}", advice)
    body = memoryview(data)[header.end() :]
    values = _plain(path, body) if header[1] == b"P2" else _binary(body, white)
    if len(values) < columns * rows:
        raise _fault(path, f"is cut off: {len(values)} of {columns * rows} pixels", "copy the file again")
    levels = values[: columns * rows].reshape(rows, columns)
    if int(levels.max()) > white:
        raise _fault(path, f"has a pixel of {levels.max()}, where white is {white}", "save the map again")
    return levels, white


def _plain(path: Path, body: memoryview) -> Levels:
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # NumPy's way to say that it stopped at other text
        try:
            values = np.fromstring(bytes(body), dtype=np.float64, sep=" ")
        except (DeprecationWarning, ValueError) as problem:
            raise _fault(path, "holds something that is not a number", "save the map again") from problem
    if not ((values >= 0.0) & (values < 65536.0)).all():
        raise _fault(path, "holds something that is not a grey level", "save the map again")
    return values.astype(np.uint16)


def _binary(body: memoryview, white: int) -> Levels:
    kind = np.dtype(np.uint8 if white < 256 else ">u2")
    return np.frombuffer(body[: len(body) - len(body) % kind.itemsize], dtype=kind).astype(np.uint16)


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

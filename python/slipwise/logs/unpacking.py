# SPDX-License-Identifier: Apache-2.0
"""Unpacks compressed pieces of logs up to a size and no further, whatever the file claims about itself."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, Protocol

from slipwise.errors import LogError

MEBIBYTE = 1 << 20
MOST_UNPACKED = 512.0  # MiB: 5 million rows, and more than recorders put into a chunk


class _Unpacker(Protocol):
    @property
    def eof(self) -> bool: ...

    @property
    def unused_data(self) -> bytes | None: ...

    def decompress(self, data: bytes, max_length: int) -> bytes: ...


def most_bytes() -> int:
    """Return how many bytes a piece may unpack to."""
    return int(MOST_UNPACKED * MEBIBYTE)


def too_large(what: str, where: str = "") -> LogError:
    """Return the error about a piece that unpacks to more than is allowed."""
    advice = "if this is right, unpack it first, or record smaller chunks"
    return LogError(f"{what} unpacks to more than {MOST_UNPACKED:g} MiB", where=where, advice=advice)


def bound_bag_readers() -> None:
    """Give the readers of bags unpackers that stop at the size allowed; theirs know no limit."""
    from rosbags.rosbag1 import reader as rosbag1
    from rosbags.rosbag2 import storage_mcap

    of_mcap = storage_mcap.DECOMPRESSORS
    of_mcap["lz4"], of_mcap["zstd"] = lambda data, _: unpack_lz4(data), lambda data, _: unpack_zstd(data)
    rosbag1.decompressors.update(lz4=unpack_lz4, bz2=unpack_bz2)


def unpack_zstd(data: bytes) -> bytes:
    """Unpack a piece compressed with Zstandard.

    Raises:
        LogError: it is larger than allowed.
    """
    return _unpacked(data, _zstd().ZstdDecompressor)


def unpack_lz4(data: bytes) -> bytes:
    """Unpack a piece compressed with LZ4; see `unpack_zstd`."""
    from lz4.frame import LZ4FrameDecompressor

    return _unpacked(data, LZ4FrameDecompressor)


def unpack_bz2(data: bytes) -> bytes:
    """Unpack a piece compressed with bzip2; see `unpack_zstd`."""
    from bz2 import BZ2Decompressor

    return _unpacked(data, BZ2Decompressor)


def _unpacked(data: bytes, make: Callable[[], _Unpacker]) -> bytes:
    """Unpack frame after frame; one that is cut off is an error, as for the readers' own unpackers."""
    left, parts = most_bytes(), []
    while data:
        unpacker = make()
        part = unpacker.decompress(data, left + 1)
        left -= len(part)
        if left < 0:
            raise too_large("a chunk of the bag")
        if not unpacker.eof:
            raise ValueError("compressed data is cut off")
        parts.append(part)
        data = unpacker.unused_data or b""
    return parts[0] if len(parts) == 1 else b"".join(parts)


def _zstd() -> Any:
    if sys.version_info >= (3, 14):
        from compression import zstd
    else:
        from backports import zstd
    return zstd

# SPDX-License-Identifier: Apache-2.0
"""Tests of unpacking: whole pieces come out whole, and none grows beyond the size allowed."""

from __future__ import annotations

import bz2
import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from logs.test_bag import Bag, drive_along_x
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from slipwise.errors import LogError
from slipwise.logs import open_log, unpacking
from slipwise.logs.unpacking import _zstd, unpack_bz2, unpack_lz4, unpack_zstd

PACKERS: list[tuple[Callable[[bytes], bytes], Callable[[bytes], bytes]]] = [
    (_zstd().compress, unpack_zstd),
    (lz4.frame.compress, unpack_lz4),
    (bz2.compress, unpack_bz2),
]
SMALL = 0.001  # MiB
RAW = np.random.default_rng(1).bytes(20_000) + bytes(300_000)


@pytest.mark.parametrize(("pack", "unpack"), PACKERS)
def test_a_piece_comes_out_as_it_went_in(
    pack: Callable[[bytes], bytes], unpack: Callable[[bytes], bytes]
) -> None:
    assert unpack(pack(RAW)) == RAW
    assert unpack(pack(RAW) + pack(b"more")) == RAW + b"more"


@pytest.mark.parametrize(("pack", "unpack"), PACKERS)
def test_a_piece_that_is_cut_off_is_an_error(
    pack: Callable[[bytes], bytes], unpack: Callable[[bytes], bytes]
) -> None:
    with pytest.raises(ValueError, match="cut off"):
        unpack(pack(RAW)[:-5])


@pytest.mark.parametrize(("pack", "unpack"), PACKERS)
def test_a_piece_is_unpacked_to_the_size_allowed_and_no_further(
    pack: Callable[[bytes], bytes], unpack: Callable[[bytes], bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    packed = pack(bytes(1 << 20))
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 1.0)
    assert len(unpack(packed)) == 1 << 20
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 0.9)
    with pytest.raises(LogError, match=r"unpacks to more than 0\.9 MiB.*unpack it first"):
        unpack(packed)


def packed_mcap(folder: Path) -> Path:
    writer = Writer2(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        return filled(Bag(), writer, folder / "bag")


def packed_messages(folder: Path) -> Path:
    writer = Writer2(folder / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3)
    writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with writer:
        return filled(Bag(), writer, folder / "bag")


def packed_rosbag1(folder: Path, kind: Any) -> Path:
    writer = Writer1(folder / "drive.bag")
    writer.set_compression(kind)
    with writer:
        return filled(Bag(ros1=True), writer, folder / "drive.bag")


def filled(bag: Bag, writer: Any, path: Path) -> Path:
    serialise = bag.store.serialize_ros1 if bag.ros1 else bag.store.serialize_cdr
    connections: dict[str, Any] = {}
    for stamp, topic, kind, message in drive_along_x(bag).messages:
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=bag.store)
        writer.write(connections[topic], stamp, bytes(serialise(message, kind)))
    return path


@pytest.mark.parametrize("kind", ["mcap", "messages", "lz4", "bz2"])
def test_a_compressed_bag_is_read_up_to_the_size_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    make: dict[str, Callable[[Path], Path]] = {
        "mcap": packed_mcap,
        "messages": packed_messages,
        "lz4": lambda folder: packed_rosbag1(folder, Writer1.CompressionFormat.LZ4),
        "bz2": lambda folder: packed_rosbag1(folder, Writer1.CompressionFormat.BZ2),
    }
    path = make[kind](tmp_path)
    assert len(open_log(path).runs[0].poses) == 100
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 5e-5 if kind == "messages" else SMALL)
    with pytest.raises(LogError, match="a chunk of the bag unpacks to more than") as caught:
        open_log(path)
    assert str(path) in caught.value.where


def test_a_compressed_table_is_read_up_to_the_size_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = "".join(f"{0.1 * i:.1f},1,0,{0.1 * i:.1f},0,0\n" for i in range(200))
    packed, stored = tmp_path / "a.csv.gz", tmp_path / "a.csv"
    packed.write_bytes(gzip.compress(f"t,cmd_v,cmd_omega,x,y,yaw\n{rows}".encode()))
    stored.write_bytes(gzip.decompress(packed.read_bytes()))
    assert len(open_log(packed).runs[0].poses) == 200
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", SMALL)
    assert len(open_log(stored).runs[0].poses) == 200
    with pytest.raises(LogError, match=r"the table unpacks to more than 0\.001 MiB \(.*a\.csv\.gz\)"):
        open_log(packed)


def test_a_parquet_file_that_claims_little_and_holds_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 16.0)
    constant = pa.array(np.zeros(1_000_000))
    pq.write_table(pa.table(dict.fromkeys(("t", "x", "y", "yaw"), constant)), tmp_path / "a.parquet")
    assert (tmp_path / "a.parquet").stat().st_size < 100_000
    with pytest.raises(LogError, match=r"the table unpacks to more than 16 MiB \(.*a\.parquet\)"):
        open_log(tmp_path / "a.parquet")

# SPDX-License-Identifier: Apache-2.0
"""Opens bags of every format and hands out the messages of chosen topics, also of damaged files."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import mmap
import shutil
import struct
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.errors import LogError
from slipwise.files import refuse_irregular
from slipwise.logs.left_out import Tally
from slipwise.logs.messages import ACKERMANN, ACKERMANN_DEFINITION, TF, TF_DEFINITION
from slipwise.logs.role_choice import Topic
from slipwise.logs.stamps import LATEST
from slipwise.logs.unpacking import bound_bag_readers, unpack_zstd

if TYPE_CHECKING:
    from rosbags.interfaces import Connection
    from rosbags.typesys.store import Typestore

MCAP_MAGIC = b"\x89MCAP0\r\n"
SQLITE_MAGIC = b"SQLite format 3\0"
ROSBAG1_MAGIC = b"#ROSBAG V2.0\n"
_ENDINGS = {MCAP_MAGIC: ".mcap", SQLITE_MAGIC: ".db3", ROSBAG1_MAGIC: ".bag"}
_LATEST_NS = int(LATEST * 1e9)
_MCAP_END = struct.pack("<BQI", 0x0F, 4, 0) + struct.pack("<BQQQI", 0x02, 20, 0, 0, 0) + MCAP_MAGIC

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class RawMessage:
    """One message as it is stored."""

    topic: str
    type: str
    received_ns: int
    data: bytes


class BagFile:
    """An open bag: one storage file, or several of one recording."""

    def __init__(self, path: Path, files: Sequence[Path], tally: Tally) -> None:
        self._path, self._tally = path, tally
        self.format = ""
        self._stack = contextlib.ExitStack()
        self._sources: list[tuple[Any, Sequence[Connection]]] = []  # readers with their connections
        self._packed = False  # each message is compressed by itself
        bound_bag_readers()
        self._seconds = 0.0
        self.missing = missing_files(path, files) if path.is_dir() else ()  # sentences
        try:
            if not (path.is_dir() and self._open_folder(path, files)):
                for file in files:
                    self._open(file)
        except BaseException:
            self._stack.close()
            raise
        self.topics = self._topics()
        self._store: Typestore | None = None

    def __enter__(self) -> BagFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def messages(self, names: set[str]) -> Iterator[RawMessage]:
        """Yield the messages of the named topics; where a file breaks off, stop there and count the rest."""
        for reader, connections in self._sources:
            wanted = [connection for connection in connections if connection.topic in names]
            if not wanted:
                continue
            expected, seen = sum(connection.msgcount for connection in wanted), 0
            try:
                for connection, received_ns, data in _all_messages(reader, wanted):
                    seen += 1
                    if connection.topic not in names:  # a damaged index leads anywhere
                        reason = "messages that the bag's index takes for those of another topic"
                        where = f"{self._path.name}, {connection.topic}"
                        self._tally.add("bad-message", reason, count=1, where=where)
                    elif self._is_time(received_ns, connection.topic):
                        content = unpack_zstd(data) if self._packed else data
                        yield RawMessage(connection.topic, connection.msgtype, received_ns, content)
            except (LogError, GeneratorExit):
                raise
            except Exception as error:  # what a reader raises on damaged bytes has no bounds
                _log.debug("reading %s broke off", self._path, exc_info=True)
                self._tally.add(
                    "damaged-bag",
                    f"messages after the bag breaks off: {_first_line(error)}",
                    count=max(expected - seen, 1),
                    where=f"{self._path.name}, message {seen + 1} of the topics that are used",
                )

    def _is_time(self, received_ns: int, topic: str) -> bool:
        """Say whether a message was received at a possible time; count it where it was not."""
        if 0 <= received_ns <= _LATEST_NS:
            return True
        reason = f"messages of {topic} received at an impossible time"
        where = f"{self._path.name}, received at {received_ns} ns"
        self._tally.add("bad-stamp", reason, count=1, where=where)
        return False

    def decode(self, message: RawMessage) -> Any:
        """Return the message as an object; None, and counted, if it does not fit its type."""
        store = self._store = self._store or _typestore(self.format == "rosbag1")
        read = store.deserialize_ros1 if self.format == "rosbag1" else store.deserialize_cdr
        try:
            return read(message.data, message.type)
        except Exception as error:  # a damaged message can fail in any way
            self.count_bad(message, error)
            return None

    def count_bad(self, message: RawMessage, error: Exception, kind: str = "") -> None:
        """Count a message that is not what its type, or the schema that is named, promises."""
        _log.debug("a message of %s cannot be decoded: %s", message.topic, error)
        reason = f"messages of {message.topic} that cannot be decoded as {kind or message.type}"
        where = f"{self._path.name}, received at {message.received_ns / 1e9:.3f} s"
        self._tally.add("bad-message", reason, count=1, where=where)

    def _open_folder(self, path: Path, files: Sequence[Path]) -> bool:
        """Open a rosbag2 folder by its metadata; say whether that went well, else its files may still do."""
        if not (path / "metadata.yaml").exists():
            return False
        from rosbags.rosbag2 import Reader

        try:
            mode = _compression_mode(path / "metadata.yaml")
            if mode == "file":  # the reader would unpack whole files, of any size, into a temporary folder
                return False
            reader: Any = self._stack.enter_context(Reader(path))
            self._packed = mode == "message"  # the reader would unpack these to any size, its storages do not
            opened = reader.storage.storages if self._packed else [reader]
            for one in opened:
                self._add(one, reader.duration / len(opened))
        except Exception:  # what a reader raises on damaged bytes has no bounds
            _log.debug("the metadata of %s cannot be used", path, exc_info=True)
            return False
        self.format = "mcap" if any(file.suffix == ".mcap" for file in files) else "rosbag2-sqlite3"
        return True

    def _open(self, file: Path) -> None:
        magic = next((magic for magic in _ENDINGS if _starts_with(file, magic)), None)
        if magic is None:
            what = "the file is empty" if file.stat().st_size == 0 else "not a bag: wrong magic bytes"
            raise LogError(what, where=str(file), advice="copy it again from the robot")
        named = self._named(file, _ENDINGS[magic])
        self.format = {MCAP_MAGIC: "mcap", SQLITE_MAGIC: "rosbag2-sqlite3", ROSBAG1_MAGIC: "rosbag1"}[magic]
        try:
            if magic == ROSBAG1_MAGIC:
                from rosbags.rosbag1 import Reader as Reader1

                reader1 = self._stack.enter_context(Reader1(named))
                self._add(reader1, reader1.duration)
            elif magic == MCAP_MAGIC and not _ends_with(file, MCAP_MAGIC):
                self._open_cut_off(file)
            else:
                from rosbags.rosbag2 import Reader as Reader2

                reader2 = self._stack.enter_context(Reader2(named))
                self._add(reader2, reader2.duration)
        except LogError as error:
            raise LogError(error.what, where=error.where or str(file), advice=error.advice) from error
        except Exception as error:  # what a reader raises on damaged bytes has no bounds
            raise LogError(
                f"the bag cannot be read: {_first_line(error)}",
                where=str(file),
                advice="it may be cut off; copy it again, or repair it with `rosbag reindex`, `mcap recover`"
                " or `ros2 bag reindex`",
            ) from error

    def _add(self, reader: Any, duration_ns: float) -> None:
        self._sources.append((reader, reader.connections))
        self._seconds += max(duration_ns, 0) / 1e9

    def _open_cut_off(self, file: Path) -> None:
        """Open an MCAP file without an end by giving its whole records one, in a temporary copy."""
        from rosbags.rosbag2.storage_mcap import McapReader

        copy = Path(self._stack.enter_context(tempfile.TemporaryDirectory())) / "whole.mcap"
        size = file.stat().st_size
        with file.open("rb") as stream, copy.open("wb") as target:
            with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
                whole = _whole_records(content)
            shutil.copyfileobj(stream, target)
            target.truncate(whole)
            target.seek(whole)
            target.write(_MCAP_END)
        reader = McapReader(copy)
        reader.open()
        self._stack.callback(reader.close)
        self._add(reader, reader.metadata.duration)
        self._tally.add(
            "damaged-bag",
            "bytes after the last whole record of a cut-off MCAP file",
            count=max(size - whole, 1),
            where=f"{file.name}, byte {whole}",
        )

    def _named(self, file: Path, ending: str) -> Path:
        """Return the file under a name with the right ending, which the readers go by."""
        if file.suffix == ending:
            return file
        link = Path(self._stack.enter_context(tempfile.TemporaryDirectory())) / f"bag{ending}"
        link.symlink_to(file.resolve())
        return link

    def _topics(self) -> tuple[Topic, ...]:
        counts: dict[tuple[str, str], int] = {}
        for _, connections in self._sources:
            for connection in connections:
                key = (connection.topic, connection.msgtype)
                counts[key] = counts.get(key, 0) + connection.msgcount
        return tuple(
            Topic(name, kind, count, count / self._seconds if self._seconds > 0.0 else float("nan"))
            for (name, kind), count in counts.items()
        )


def bag_files(path: Path) -> list[Path]:
    """Return the storage files of a bag: the file itself, or those in a rosbag2 folder, by name.

    Raises:
        LogError: the folder holds no bag.
    """
    if not path.is_dir():
        return [path]
    files = sorted(file for file in path.iterdir() if file.suffix in (".mcap", ".db3", ".bag"))
    if not files:
        packed = any(file.name.endswith(".zstd") for file in path.iterdir())
        advice = (
            "decompress its .zstd files first" if packed else "name a folder with .mcap, .db3 or .bag files"
        )
        raise LogError("the folder holds no bag", where=str(path), advice=advice)
    for file in files:
        refuse_irregular(file, error=LogError)
    return sorted(files, key=_split_number)


def missing_files(path: Path, files: Sequence[Path]) -> tuple[str, ...]:
    """Name the files that a rosbag2 folder lacks: its metadata list them, or their numbers imply them."""
    from slipwise.models.yaml_file import read_yaml

    found = {file.name for file in files}
    listed: list[str] = []
    with contextlib.suppress(Exception):  # damaged metadata may hold anything
        information = read_yaml(path / "metadata.yaml", error=LogError)["rosbag2_bagfile_information"]
        listed = [Path(str(name)).name for name in information["relative_file_paths"]]
    lost = [name for name in listed if name not in found]
    gone = "is not there: its part of the drive is missing"
    said = [f"{name}, listed in metadata.yaml, {gone}" for name in lost]
    numbers = {(stem, ending): number for stem, number, ending in map(_split_number, files) if number >= 0}
    for (stem, ending), last in numbers.items():
        names = [f"{stem}_{k}{ending}" for k in range(last)]
        said += [
            f"{name}, which comes before {stem}_{last}{ending}, {gone}"
            for name in names
            if name not in found and name not in lost
        ]
    return tuple(said)


def files_sha256(files: Sequence[Path]) -> str:
    """Return the SHA-256 of the files' bytes, one after the other."""
    digest = hashlib.sha256()
    for file in files:
        with file.open("rb") as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()


def is_bag(path: Path) -> bool:
    """Say whether the file starts like a bag."""
    return any(_starts_with(path, magic) for magic in _ENDINGS)


def _all_messages(reader: Any, wanted: Sequence[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
    from rosbags.rosbag2.storage_mcap import McapReader

    if isinstance(reader, McapReader):
        return reader.messages_scan(wanted, 0, 1 << 64)  # its own end leaves out late stamps in silence
    found: Iterator[tuple[Connection, int, bytes]] = reader.messages(connections=wanted)
    return found


@functools.cache
def _typestore(ros1: bool) -> Typestore:
    """Return the standard types; definitions in the bag are not needed for them."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    for kind, definition in ((ACKERMANN, ACKERMANN_DEFINITION), (TF, TF_DEFINITION)):
        if kind not in store.fielddefs:
            store.register(get_types_from_msg(definition, kind))
    return store


def _compression_mode(metadata: Path) -> str:
    """Return how a rosbag2 folder is compressed: "file", "message", or neither."""
    from slipwise.models.yaml_file import read_yaml

    information = read_yaml(metadata, error=LogError)["rosbag2_bagfile_information"]
    return str(information.get("compression_mode", "")).lower()


def _whole_records(content: bytes | mmap.mmap) -> int:
    """Return the length of the part of an MCAP file that consists of whole records of the data section."""
    position = len(MCAP_MAGIC)
    while position + 9 <= len(content):
        kind, size = struct.unpack_from("<BQ", content, position)
        if position + 9 + size > len(content) or kind in (0x0F, 0x02):
            break
        position += 9 + size
    return position


def _split_number(file: Path) -> tuple[str, int, str]:
    """Sort recording_2 before recording_10."""
    stem, _, number = file.stem.rpartition("_")
    return (stem, int(number), file.suffix) if number.isdigit() else (file.stem, -1, file.suffix)


def _starts_with(file: Path, magic: bytes) -> bool:
    with file.open("rb") as stream:
        return stream.read(len(magic)) == magic


def _ends_with(file: Path, magic: bytes) -> bool:
    with file.open("rb") as stream:
        stream.seek(-min(len(magic), file.stat().st_size), 2)
        return stream.read() == magic


def _first_line(error: Exception) -> str:
    return (str(error) or type(error).__name__).splitlines()[0][:200]

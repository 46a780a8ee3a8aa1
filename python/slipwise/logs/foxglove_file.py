# SPDX-License-Identifier: Apache-2.0
"""Opens MCAP files whose messages are protobuf or JSON, as programs without ROS write them."""

from __future__ import annotations

import logging
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from slipwise.errors import LogError
from slipwise.extras import to_install
from slipwise.logs.bag_file import MCAP_MAGIC, BagFile, RawMessage
from slipwise.logs.foxglove_messages import as_ros, from_json, ros_type
from slipwise.logs.left_out import Tally
from slipwise.logs.role_choice import Topic
from slipwise.logs.unpacking import most_bytes, unpack_lz4, unpack_zstd

JSON, PROTOBUF = "json", "protobuf"  # encodings of messages
_SCHEMAS = (b"protobuf", b"jsonschema")  # encodings of their schemas
_CHUNK, _SCHEMA, _FOOTER = 0x06, 0x03, 0x02
_FOOTER_SIZE = 9 + 20 + len(MCAP_MAGIC)
_MOST_SUMMARY = 64 << 20  # bytes

_log = logging.getLogger(__name__)


def open_bag(path: Path, files: Sequence[Path], tally: Tally) -> BagFile:
    """Open a bag: one of ROS, or an MCAP file with other encodings.

    Raises:
        LogError: it is damaged, or a library that it needs is not installed.
    """
    if len(files) == 1 and has_other_schemas(files[0]):
        return FoxgloveFile(path, files, tally)
    return BagFile(path, files, tally)


def has_other_schemas(file: Path) -> bool:
    """Say whether an MCAP file has schemas of protobuf or JSON, by its summary or else its first chunk."""
    with file.open("rb") as stream:
        if stream.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
            return False
        size = stream.seek(0, 2)
        stream.seek(max(size - _FOOTER_SIZE, 0))
        end = stream.read()
        start = len(MCAP_MAGIC)
        if len(end) == _FOOTER_SIZE and end.endswith(MCAP_MAGIC) and end[0] == _FOOTER:
            start = struct.unpack_from("<Q", end, 9)[0] or start
        stream.seek(min(start, size))
        return _names_other_schemas(stream.read(_MOST_SUMMARY))


def _names_other_schemas(records: bytes) -> bool:
    """Look through whole records for schemas, in the first chunk too."""
    at = 0
    while at + 9 <= len(records):
        kind, length = struct.unpack_from("<BQ", records, at)
        content = records[at + 9 : at + 9 + length]
        if kind == _SCHEMA and _encoding(content) in _SCHEMAS:
            return True
        if kind == _CHUNK:
            return any(encoding in content for encoding in _SCHEMAS) or _in_chunk(content)
        at += 9 + length
    return False


def _encoding(schema: bytes) -> bytes:
    try:
        (name,) = struct.unpack_from("<I", schema, 2)
        (size,) = struct.unpack_from("<I", schema, 6 + name)
    except struct.error:
        return b""
    return schema[10 + name : 10 + name + size]


def _in_chunk(content: bytes) -> bool:
    try:
        (length,) = struct.unpack_from("<I", content, 28)
        name, packed = content[32 : 32 + length], content[40 + length :]
        plain = {b"zstd": unpack_zstd, b"lz4": unpack_lz4}[name](packed)
    except Exception:  # damaged: whoever reads it says so
        return False
    return any(encoding in plain for encoding in _SCHEMAS)


class FoxgloveFile(BagFile):
    """An open MCAP file; its messages are named by the ROS types that their schemas stand for."""

    def __init__(self, path: Path, files: Sequence[Path], tally: Tally) -> None:
        self._file = files[0]
        self._counts: dict[tuple[str, str], int] = {}
        self._decoders: dict[tuple[str, str], tuple[str, Callable[[bytes], Any]]] = {}
        super().__init__(path, files, tally)

    def messages(self, names: set[str]) -> Iterator[RawMessage]:
        """Yield the messages of the named topics; where the file breaks off, stop there and count it."""
        try:
            for topic, kind, received_ns, data in self._records():
                if topic in names and self._is_time(received_ns, topic):
                    yield RawMessage(topic, kind, received_ns, data)
        except (LogError, GeneratorExit):
            raise
        except Exception as error:  # what a reader raises on damaged bytes has no bounds
            reason = f"bytes after the file breaks off: {type(error).__name__}"
            self._tally.add("damaged-bag", reason, count=1, where=self._path.name)

    def decode(self, message: RawMessage) -> Any:
        """Return the message in the shape of its ROS type; None, and counted, if it does not fit."""
        schema, decoder = self._decoders[message.topic, message.type]
        try:
            return as_ros(schema, decoder(message.data))
        except Exception as error:  # a damaged message can fail in any way
            self.count_bad(message, error, schema)
            return None

    def _open(self, file: Path) -> None:
        self.format = "mcap"
        times = []
        try:
            for topic, kind, received_ns, _ in self._records():
                self._counts[topic, kind] = self._counts.get((topic, kind), 0) + 1
                times.append(received_ns)
        except LogError:
            raise
        except ImportError as error:
            advice = to_install("foxglove")
            raise LogError(
                "mcap-protobuf-support is not installed", where=str(file), advice=advice
            ) from error
        except Exception as error:  # damaged: what was whole is read, and `messages` counts the rest
            _log.debug("%s breaks off: %s", file, error)
        self._seconds = (max(times) - min(times)) / 1e9 if times else 0.0

    def _topics(self) -> tuple[Topic, ...]:
        rate = 1.0 / self._seconds if self._seconds > 0.0 else float("nan")
        return tuple(Topic(name, kind, n, n * rate) for (name, kind), n in self._counts.items())

    def _records(self) -> Iterator[tuple[str, str, int, bytes]]:
        """Yield topic, type, time of receipt and content of each message that can be decoded."""
        from mcap.records import Channel, Chunk, Message, Schema
        from mcap.stream_reader import StreamReader, breakup_chunk
        from mcap_protobuf.decoder import DecoderFactory

        factory, schemas = DecoderFactory(), {}
        channels: dict[int, tuple[str, str] | None] = {}
        with self._file.open("rb") as stream:
            reader = StreamReader(stream, emit_chunks=True, record_size_limit=most_bytes())
            for whole in reader.records:
                for record in breakup_chunk(_unpacked(whole)) if isinstance(whole, Chunk) else (whole,):
                    if isinstance(record, Schema):
                        schemas[record.id] = record
                    elif isinstance(record, Channel):
                        schema = schemas.get(record.schema_id)
                        channels[record.id] = self._channel(record, schema, factory)
                    elif isinstance(record, Message):
                        key = channels.get(record.channel_id)
                        if key is not None:
                            yield key[0], key[1], record.log_time, record.data

    def _channel(self, channel: Any, schema: Any, factory: Any) -> tuple[str, str] | None:
        """Return a channel's topic and type, and keep what decodes it; None where nothing does."""
        name = schema.name if schema is not None else ""
        key = (channel.topic, ros_type(name))
        if channel.message_encoding == JSON:
            self._decoders[key] = (name, from_json)
        elif channel.message_encoding == PROTOBUF and schema is not None:
            self._decoders[key] = (name, factory.decoder_for(PROTOBUF, schema))
        else:
            reason = f"channels encoded as {channel.message_encoding or 'nothing'} among protobuf and JSON"
            self._tally.add("other-encoding", reason, count=1, where=f"{self._path.name}, {channel.topic}")
            return None
        return key


def _unpacked(chunk: Any) -> Any:
    """Return the chunk with its content unpacked, up to the size that is allowed."""
    if chunk.compression == "":
        return chunk
    unpack = {"zstd": unpack_zstd, "lz4": unpack_lz4}.get(chunk.compression)
    if unpack is None:
        raise ValueError(f"compression {chunk.compression}")
    return replace(chunk, compression="", data=unpack(chunk.data))

# SPDX-License-Identifier: Apache-2.0
"""Records every output of the node as ROS 2 messages into one MCAP file, whole or not at all."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING

from rosbags.rosbag2.storage_mcap import McapWriter

from slipwise.errors import OutputError, SlipwiseError
from slipwise.files import output_errors, written_place
from slipwise.live.outputs import Output
from slipwise.live.ros_messages import TOPICS, RosMessages
from slipwise.live.watch.output_thread import OutputThread
from slipwise.part_folder import is_locked, locked

if TYPE_CHECKING:
    from rosbags.interfaces import Connection, Qos
    from rosbags.rosbag2 import Writer

SAVED_EVERY = 10.0  # s; what a killed process loses at most; each saving keeps 220 bytes of index in memory
LOCK = ".writer"


class Recorder:
    """Writes beside the file and moves it into place at the end.

    Until then the folder `<file>.part` holds what was recorded. A process that is killed leaves it there,
    whole up to its last 10 s: slipwise reads it as it is, `mcap recover` completes it, and the next recording
    under the same name keeps it beside as `<file's stem>-recovered-1.mcap`.
    """

    def __init__(self, path: Path, *, name: str = "slipwise") -> None:
        """Begin to record.

        Args:
            path: the file, replaced at the end where there is one.
            name: of the node, whose topics are below it.

        Raises:
            OutputError: the file cannot be written, or is recorded to by another process.
        """
        self.path = path
        self._notices: list[str] = []
        self._lock = contextlib.ExitStack()
        self._messages = RosMessages(name)
        self._last = 0  # ns, the newest stamp
        self._saved = time.monotonic()
        self._closed = False
        with output_errors(path):
            self._place = written_place(path)
            if self._place.exists() and not self._place.is_file():
                raise OutputError("cannot record: not a file", where=str(path), advice="name a file")
            self._place.parent.mkdir(parents=True, exist_ok=True)
            self._folder = self._place.with_name(f"{self._place.name}.part")
            self._keep_what_was_left()
            self._writer = self._open_writer()
            self._lock.enter_context(locked(self._folder / LOCK))
        self._connections = {topic: self._connect(name, topic) for topic in TOPICS}
        self._thread = OutputThread(self._write, name="slipwise-record", rest=self._save_now_and_then)

    def take(self, output: Output) -> None:
        """Record an output."""
        self._thread.put(output)
        if self._thread.failure is not None and not self._closed:
            self._give_up(self._thread.failure)

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: a disk that is full, outputs left out."""
        said, self._notices = self._notices, []
        return said

    def close(self) -> None:
        """Complete the file and move it into place; where that fails, `notices` says what is where."""
        if self._closed:
            return
        done = self._thread.close()
        if self._thread.failure is not None:
            self._give_up(self._thread.failure)
            return
        self._closed = True
        if not done:
            self._notices.append(f"the disk is too slow: what was recorded is in {self._folder}")
            return
        if self._thread.left_out:
            self._notices.append(f"{self._thread.left_out} outputs were not recorded: the disk is too slow")
        try:
            with output_errors(self.path):
                self._complete()
        except (SlipwiseError, ValueError) as error:
            self._notices.append(f"{error}; what was recorded is in {self._folder}")
        finally:
            self._lock.close()

    def _complete(self) -> None:
        self._writer.close()
        file = _recording(self._folder)
        with file.open("rb+") as stream:
            os.fsync(stream.fileno())
        file.replace(self._place)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _give_up(self, failure: Exception) -> None:
        self._closed = True
        self._writer.abort()
        self._lock.close()
        reason = failure.strerror if isinstance(failure, OSError) else str(failure)
        self._notices.append(f"recording stopped: {reason}; what was recorded is in {self._folder}")

    def _write(self, output: Output) -> None:
        for message in self._messages.of(output):
            self._last = message.stamp or self._last  # without a stamp of its own: with the one before
            self._writer.write(self._connections[message.topic], self._last, message.payload)

    def _save_now_and_then(self) -> None:
        """Hand what is held back to the disk, so that a killed process leaves it."""
        if time.monotonic() - self._saved < SAVED_EVERY:
            return
        self._saved = time.monotonic()
        storage = self._writer.storage
        if isinstance(storage, McapWriter):
            if storage.chunk.msgs:
                storage.close_chunk()
            storage.bio.flush()
            os.fsync(storage.bio.fileno())

    def _open_writer(self) -> Writer:
        from rosbags.rosbag2 import StoragePlugin, Writer

        writer = Writer(self._folder, version=9, storage_plugin=StoragePlugin.MCAP)
        writer.open()
        return writer

    def _connect(self, name: str, topic: str) -> Connection:
        kind = TOPICS[topic]
        return self._writer.add_connection(
            f"/{name.strip('/')}/{topic}",
            kind.type,
            typestore=self._messages.store,
            offered_qos_profiles=[_quality(latched=kind.latched)],
        )

    def _keep_what_was_left(self) -> None:
        """Move the recording of a process that was killed out of the way.

        Raises:
            OutputError: that process lives, or what is in the way was not left by one.
        """
        if not os.path.lexists(self._folder):
            return
        ours = {_recording(self._folder).name, LOCK, "metadata.yaml"}
        mine = self._folder.is_dir() and not self._folder.is_symlink()
        if not mine or not {file.name for file in self._folder.iterdir()} <= ours:
            advice = "move it away or choose another name"
            raise OutputError("this is in the way of the recording", where=str(self._folder), advice=advice)
        if (self._folder / LOCK).exists() and is_locked(self._folder / LOCK):
            advice = "choose another name"
            raise OutputError("another process records to this file", where=str(self.path), advice=advice)
        left = _recording(self._folder)
        if left.is_file() and left.stat().st_size > 0:
            kept = _free_name(self._place)
            left.rename(kept)
            self._notices.append(f"an earlier recording that was cut off is kept as {kept}")
        shutil.rmtree(self._folder)


def _recording(folder: Path) -> Path:
    """Return the file in a folder that the writer makes."""
    return folder / f"{folder.name}.mcap"


def _free_name(place: Path) -> Path:
    number = 1
    while (kept := place.with_name(f"{place.stem}-recovered-{number}.mcap")).exists():
        number += 1
    return kept


def _quality(*, latched: bool) -> Qos:
    """Return the quality of service that a player offers again."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    never = QosTime(2147483647, 4294967295)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else 10,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=never,
        lifespan=never,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=never,
        avoid_ros_namespace_conventions=False,
    )

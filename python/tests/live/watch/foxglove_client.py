# SPDX-License-Identifier: Apache-2.0
"""A client of Foxglove's WebSocket protocol: what is advertised, and the messages of chosen topics."""

from __future__ import annotations

import contextlib
import json
import struct
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

from websockets.sync.client import connect
from websockets.typing import Subprotocol

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
_MESSAGE = 1  # binary opcode
_HEAD = struct.Struct("<BIQ")  # opcode, subscription, log time [ns]


@dataclass
class FoxgloveClient:
    """Used as a context manager."""

    address: str
    info: dict[str, Any] = field(default_factory=dict)
    channels: dict[str, dict[str, Any]] = field(default_factory=dict)  # by topic

    def __enter__(self) -> FoxgloveClient:
        protocols = [Subprotocol(name) for name in SUBPROTOCOLS]
        self._stack = contextlib.ExitStack()
        self._socket = self._stack.enter_context(connect(self.address, subprotocols=protocols, max_size=None))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    @property
    def subprotocol(self) -> str | None:
        """The protocol that the server chose."""
        return self._socket.subprotocol

    def wait_for_channels(self, topics: set[str], timeout: float = 20.0) -> None:
        """Read until all of the topics are advertised."""
        while not topics <= set(self.channels):
            self._read(timeout)

    def subscribe(self, topics: set[str]) -> None:
        """Ask for the messages of topics."""
        wanted = [{"id": self.channels[t]["id"], "channelId": self.channels[t]["id"]} for t in topics]
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))

    def message(self, timeout: float = 20.0) -> tuple[str, int, bytes]:
        """Return the next message: topic, log time [ns], payload."""
        while True:
            found = self._read(timeout)
            if found is not None:
                return found

    def _read(self, timeout: float) -> tuple[str, int, bytes] | None:
        data = self._socket.recv(timeout)
        if isinstance(data, str):
            said = json.loads(data)
            if said["op"] == "serverInfo":
                self.info = said
            elif said["op"] == "advertise":
                self.channels |= {channel["topic"]: channel for channel in said["channels"]}
            return None
        opcode, subscription, time = _HEAD.unpack_from(data)
        if opcode != _MESSAGE:
            return None
        topic = next(name for name, channel in self.channels.items() if channel["id"] == subscription)
        return topic, time, data[_HEAD.size :]

# SPDX-License-Identifier: Apache-2.0
"""Names, tokens and attachments by which nodes of rmw_zenoh know each other."""

from __future__ import annotations

import hashlib
import struct
import time
from dataclasses import dataclass

from slipwise.live.wires.ros_types import dds_type, ros_type, type_hash

#: Quality of service in a token: reliable, the last ten; latched: the last one, for those who come later.
_USUAL = "::,10:,:,:,,"
_LATCHED = ":1:,1:,:,:,,"


@dataclass(frozen=True)
class Endpoint:
    """A publisher or a subscription, as its token tells."""

    session: str  # id of the Zenoh session that it belongs to
    publishes: bool
    node: str
    topic: str
    type: str  # of ROS


def data_key(domain: int, topic: str, type_name: str, *, any_hash: bool = False) -> str:
    """Return the key on which a topic's messages, or a service's requests, are.

    Args:
        domain: of ROS.
        topic: or service, with its slash.
        type_name: such as "nav_msgs/msg/Odometry".
        any_hash: hear and ask whatever the hash is: older ROS writes none.
    """
    return "/".join((str(domain), topic[1:], dds_type(type_name), "*" if any_hash else type_hash(type_name)))


@dataclass(frozen=True)
class NodeTokens:
    """Writes the tokens of one node."""

    domain: int
    session: str
    node: str
    namespace: str = "/"

    def of_node(self) -> str:
        """Return the token of the node itself."""
        return "/".join(self._start(0, "NN"))

    def of_endpoint(self, number: int, topic: str, type_name: str, *, publishes: bool, latched: bool) -> str:
        """Return the token of a publisher or a subscription.

        Args:
            number: of the endpoint in its node, from 1.
            topic: with its slash.
            type_name: of ROS.
            publishes: a publisher; otherwise a subscription.
            latched: whether the last message is kept, or wanted.
        """
        start = self._start(number, "MP" if publishes else "MS")
        quality = _LATCHED if latched else _USUAL
        return "/".join((*start, _mangled(topic), dds_type(type_name), type_hash(type_name), quality))

    def _start(self, number: int, kind: str) -> tuple[str, ...]:
        enclave = _mangled("/")
        names = (enclave, _mangled(self.namespace or "/"), self.node)
        return ("@ros2_lv", str(self.domain), self.session, "0", str(number), kind, *names)


def read_token(token: str) -> Endpoint | None:
    """Return what a token tells of a publisher or a subscription; None for other tokens."""
    parts = token.split("/")
    if len(parts) != 13 or parts[0] != "@ros2_lv" or parts[5] not in ("MP", "MS"):
        return None
    return Endpoint(parts[2], parts[5] == "MP", parts[8], parts[9].replace("%", "/"), ros_type(parts[10]))


def gid_of(token: str) -> bytes:
    """Return the 16 bytes by which messages of a publisher are told from those of others."""
    return hashlib.blake2s(token.encode(), digest_size=16).digest()


def attachment(number: int, gid: bytes) -> bytes:
    """Return what rmw_zenoh wants beside a message: its number, the time [ns], and whose it is; 33 bytes."""
    return struct.pack("<qqB16s", number, time.time_ns(), len(gid), gid)


def _mangled(name: str) -> str:
    return name.replace("/", "%")

# SPDX-License-Identifier: Apache-2.0
"""Makes a participant of Cyclone DDS a node of ROS 2: its name, and which readers and writers are its."""

from __future__ import annotations

from typing import Any

from slipwise.live.wires.cyclone_bytes import write_cdr
from slipwise.live.wires.cyclone_types import cyclone_type
from slipwise.live.wires.ros_types import ros_types, type_hash

_INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"

#: What ROS expects in the user data of a participant: it is in no enclave of its own.
PARTICIPANT_DATA = b"enclave=/;"


def endpoint_data(type_name: str) -> bytes:
    """Return what ROS expects in the user data of a reader or writer: the hash of its type."""
    return f"typehash={type_hash(type_name)};".encode()


class CycloneGraph:
    """Announces one node on `ros_discovery_info`, where ROS 2 (Iron and later) looks for names."""

    def __init__(self, participant: Any, node_name: str, namespace: str) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        self._names = (namespace or "/", node_name)
        self._participant = participant.guid.bytes
        self._readers: list[bytes] = []
        self._writers: list[bytes] = []
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.TransientLocal,
            Policy.History.KeepLast(1),
            Policy.DataRepresentation(use_cdrv0_representation=True),
            Policy.Userdata(endpoint_data(_INFO)),
        )
        self._topic = Topic(participant, "ros_discovery_info", cyclone_type(_INFO))
        self._writer = DataWriter(participant, self._topic, qos=qos)
        self._announce()

    def add(self, *, reader: Any = None, writer: Any = None) -> None:
        """Take in a reader or writer of the node."""
        if reader is not None:
            self._readers.append(reader.guid.bytes)
        if writer is not None:
            self._writers.append(writer.guid.bytes)
        self._announce()

    def remove(self, reader: Any) -> None:
        """Leave out a reader that will be closed."""
        self._readers.remove(reader.guid.bytes)
        self._announce()

    def _announce(self) -> None:
        types = ros_types().types
        gid, info = types["rmw_dds_common/msg/Gid"], types["rmw_dds_common/msg/NodeEntitiesInfo"]
        namespace, name = self._names
        message = types[_INFO](
            gid=_gid(gid, self._participant),
            node_entities_info_seq=[
                info(
                    node_namespace=namespace,
                    node_name=name,
                    reader_gid_seq=[_gid(gid, guid) for guid in self._readers],
                    writer_gid_seq=[_gid(gid, guid) for guid in self._writers],
                )
            ],
        )
        write_cdr(self._writer, bytes(ros_types().serialize_cdr(message, _INFO, little_endian=True)))


def _gid(gid: Any, guid: bytes) -> Any:
    import numpy as np

    return gid(data=np.frombuffer(guid, dtype=np.uint8))

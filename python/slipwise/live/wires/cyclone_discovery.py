# SPDX-License-Identifier: Apache-2.0
"""Who publishes what, as the discovery of Cyclone DDS hears it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from slipwise.live.wires.ros_types import ros_type
from slipwise.live.wires.wire import Quality

_ALIVE = 16  # DDS_ALIVE_INSTANCE_STATE

#: The first two bytes of a participant's key are the vendor's, by the RTPS standard.
_VENDORS = {
    (1, 1): "RTI Connext",
    (1, 2): "Vortex OpenSplice",
    (1, 3): "OpenDDS",
    (1, 6): "CoreDX",
    (1, 15): "eProsima Fast DDS",
    (1, 16): "Eclipse Cyclone DDS",
    (1, 17): "GurumDDS",
    (1, 18): "RustDDS",
    (1, 20): "Dust DDS",
}


@dataclass(frozen=True)
class Publication:
    """A publisher of another process or of this one."""

    topic: str  # on the wire, such as "rt/odom"
    type: str  # of ROS, such as "nav_msgs/msg/Odometry"
    participant: bytes  # [16] key of the participant
    handle: int  # by which readers name their matches
    quality: Quality

    @property
    def vendor(self) -> str:
        """Name of the middleware that publishes."""
        vendor = (self.participant[0], self.participant[1])
        return _VENDORS.get(vendor, f"a middleware of vendor {vendor[0]}.{vendor[1]}")


class CycloneDiscovery:
    """Follows the publications; not for several threads at once."""

    def __init__(self, participant: Any) -> None:
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        self._reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        #: Triggers as soon as publications come or go.
        self.condition = ReadCondition(self._reader, ViewState.Any | SampleState.NotRead | InstanceState.Any)
        self._publications: dict[bytes, Publication] = {}

    def refresh(self) -> bool:
        """Take in what is new; return whether anything was."""
        changed = False
        while taken := self._reader.take(N=64):
            changed = True
            for endpoint in taken:
                key = endpoint.key.bytes
                if endpoint.sample_info.instance_state == _ALIVE:
                    self._publications[key] = _publication(endpoint)
                else:
                    self._publications.pop(key, None)
        return changed

    def publications(self) -> list[Publication]:
        """Return all publications that are known."""
        return list(self._publications.values())


def _publication(endpoint: Any) -> Publication:
    from cyclonedds.qos import Policy

    keeping = (Policy.Durability.TransientLocal, Policy.Durability.Transient, Policy.Durability.Persistent)
    offered = list(endpoint.qos)
    return Publication(
        topic=endpoint.topic_name,
        type=ros_type(endpoint.type_name),
        participant=endpoint.participant_key.bytes,
        handle=endpoint.sample_info.instance_handle,
        quality=Quality(
            reliable=any(isinstance(policy, Policy.Reliability.Reliable) for policy in offered),
            latched=any(policy in offered for policy in keeping),
        ),
    )

# SPDX-License-Identifier: Apache-2.0
"""Cyclone DDS confined to this host by default; the wires of a process share a domain."""

from __future__ import annotations

import os
import threading
from dataclasses import dataclass
from typing import Any

from slipwise.errors import SettingsError

# Fast DDS 3 (ROS 2 Kilted) describes arrays and sequences in a way that Cyclone refuses in silence, so that
# Odometry never arrives. Without the descriptions types are compared by their names, as ROS itself does. By
# RTPS, vendors are 1.1 Connext, 1.15 Fast DDS, 1.16 Cyclone, 1.17 GurumDDS.
_TRUST_NAMES = (
    "<Compatibility><IgnoreTypeInformation>1.1,1.15,1.16,1.17</IgnoreTypeInformation></Compatibility>"
)

_LOOPBACK = (
    '<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>"
    '<Peers><Peer Address="127.0.0.1"/></Peers></Discovery>'
)


def cyclone_config(*, network: bool) -> str:
    """Return the configuration of a domain as XML.

    Args:
        network: talk to other hosts, by multicast and as `CYCLONEDDS_URI` says; otherwise to this one alone.
    """
    if not network:
        return f"<CycloneDDS><Domain>{_TRUST_NAMES}{_LOOPBACK}</Domain></CycloneDDS>"
    own = f"<CycloneDDS><Domain>{_TRUST_NAMES}</Domain></CycloneDDS>"
    given = os.environ.get("CYCLONEDDS_URI", "")
    return f"{own},{given}" if given else own


@dataclass
class _Open:
    domain: Any
    network: bool
    users: int


_open: dict[int, _Open] = {}
_lock = threading.Lock()


def open_domain(number: int, *, network: bool) -> None:
    """Create a domain, or count one user more of it; `close_domain` is its opposite.

    Raises:
        SettingsError: it cannot be created, or the process uses it with another configuration.
    """
    from cyclonedds.core import DDSException
    from cyclonedds.domain import Domain

    with _lock:
        there = _open.get(number)
        if there is not None and there.network != network:
            raise SettingsError(
                f"domain {number} is in use with another setting of the network", advice="use another domain"
            )
        if there is None:
            try:
                there = _Open(Domain(number, cyclone_config(network=network)), network, 0)
            except DDSException as error:
                raise SettingsError(
                    f"Cyclone DDS cannot open domain {number}: {error}",
                    advice="look at CYCLONEDDS_URI, and whether the process uses Cyclone DDS otherwise too",
                ) from error
            _open[number] = there
        there.users += 1


def close_domain(number: int) -> None:
    """Give a domain back; it goes with its last user."""
    with _lock:
        there = _open[number]
        there.users -= 1
        if there.users == 0:
            del _open[number]

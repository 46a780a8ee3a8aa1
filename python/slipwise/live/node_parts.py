# SPDX-License-Identifier: Apache-2.0
"""The parts that a live node is put together of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from slipwise.live.applied import AppliedModel
from slipwise.live.cache import Cache
from slipwise.live.gates import Gates
from slipwise.live.handover import Handover
from slipwise.live.intake import Intake
from slipwise.live.learning import Learning
from slipwise.live.move_adviser import MoveAdviser
from slipwise.live.said import Said
from slipwise.live.status import Identity
from slipwise.live.transport import Transport
from slipwise.live.watch.watcher import Watcher


@dataclass(frozen=True)
class NodeParts:
    """What a node is made of."""

    who: Identity
    transport: Transport
    learning: Learning
    intake: Intake
    gates: Gates
    said: Said
    adviser: MoveAdviser
    watchers: Sequence[Watcher] = ()
    applied: AppliedModel | None = None
    handover: Handover | None = None
    cache: Cache | None = None

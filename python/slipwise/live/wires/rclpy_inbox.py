# SPDX-License-Identifier: Apache-2.0
"""Takes what waits in subscriptions of rclpy, many at a time: an executor would wake up for each message."""

from __future__ import annotations

import time
from collections.abc import Iterable
from importlib import import_module
from operator import itemgetter
from typing import Any

from slipwise.live.wires.wire import OnMessage

_AT_ONCE = 256  # messages of one subscription, so that a flood on one keeps no other waiting
_LATE = 60.0  # s; what is said to have arrived longer ago, or later than now, was dated by another clock

#: A message, when it arrived [s since 1970], and who takes it.
Taken = tuple[float, bytes, OnMessage]


def left_to_us() -> Any:
    """Return a callback group whose subscriptions no executor takes from: `take_all` does."""
    groups: Any = import_module("rclpy.callback_groups")

    class LeftToUs(groups.CallbackGroup):  # type: ignore[misc]
        def can_execute(self, _entity: object) -> bool:
            return False

        def beginning_execution(self, _entity: object) -> bool:
            return False

        def ending_execution(self, _entity: object) -> None:
            """Nothing was begun."""

    return LeftToUs()


def take_all(subscriptions: Iterable[tuple[Any, OnMessage]]) -> list[Taken]:
    """Return what waits in raw subscriptions, in the order of its arrival.

    The middleware says when a message arrived; where it does not, it is now.
    """
    found: list[Taken] = []
    now = time.time()
    for subscription, deliver in subscriptions:
        kind = subscription.msg_type
        handle = subscription.handle
        with handle:
            for _ in range(_AT_ONCE):
                taken = handle.take_message(kind, True)  # raw
                if taken is None:
                    break
                message, about = taken
                arrived = about["received_timestamp"] / 1e9
                found.append((arrived if now - _LATE < arrived <= now else now, bytes(message), deliver))
    found.sort(key=itemgetter(0))
    return found

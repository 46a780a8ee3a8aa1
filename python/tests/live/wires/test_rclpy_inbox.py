# SPDX-License-Identifier: Apache-2.0
"""What waits in subscriptions is taken at once, in the order of its arrival, whatever topic it came on."""

from __future__ import annotations

import time
from contextlib import nullcontext
from types import SimpleNamespace

from slipwise.live.wires.rclpy_inbox import take_all


class Handle(nullcontext[None]):
    """Of a subscription: messages, and when the middleware says that they came [s]; 0: it does not say."""

    def __init__(self, *waiting: tuple[bytes, float]) -> None:
        super().__init__()
        self.waiting = list(waiting)

    def take_message(self, _kind: object, raw: bool) -> tuple[bytes, dict[str, int]] | None:
        assert raw
        if not self.waiting:
            return None
        message, arrived = self.waiting.pop(0)
        return message, {"received_timestamp": int(arrived * 1e9)}


def taken(*handles: Handle) -> list[tuple[float, bytes]]:
    subscriptions = [SimpleNamespace(handle=handle, msg_type=None) for handle in handles]
    found = take_all([(each, lambda _message, _arrived: None) for each in subscriptions])
    return [(arrived, message) for arrived, message, _ in found]


def test_messages_of_several_topics_keep_the_order_in_which_they_came() -> None:
    now = time.time()
    commands = Handle((b"first", now - 0.004), (b"third", now - 0.002))
    poses = Handle((b"second", now - 0.003))
    found = taken(commands, poses)
    assert [message for _, message in found] == [b"first", b"second", b"third"]
    assert abs(found[1][0] - (now - 0.003)) < 1e-6


def test_a_time_of_arrival_that_is_missing_or_of_another_clock_is_now() -> None:
    now = time.time()
    for said in (0.0, now - 3600.0, now + 3600.0):
        ((arrived, _),) = taken(Handle((b"x", said)))
        assert now <= arrived < now + 10.0

# SPDX-License-Identifier: Apache-2.0
"""A message that is not understood stops nothing, and a closed wire hands nothing over."""

from __future__ import annotations

import pytest

from slipwise.errors import SettingsError
from slipwise.live.wires.delivery import Delivery
from slipwise.live.wires.silence import PATIENCE, PublisherSeen, SilenceWatch


def test_a_callback_that_fails_does_not_stop_the_next_message() -> None:
    delivery, taken = Delivery(SilenceWatch()), []

    def take(message: bytes, arrived: float) -> None:
        taken.append((message, arrived))
        raise ValueError("not understood")

    deliver = delivery.to("/odom", take)
    for message in (b"1", b"2"):
        deliver(message, 1.0)
    assert taken == [(b"1", 1.0), (b"2", 1.0)]


def test_what_was_heard_is_not_said_to_be_silent() -> None:
    now = [0.0]
    silence = SilenceWatch(lambda: now[0])
    delivery = Delivery(silence)
    for topic in ("/odom", "/pose"):
        silence.want(topic, "nav_msgs/msg/Odometry")
        silence.seen(topic, [PublisherSeen("a middleware", "nav_msgs/msg/Odometry", True)])
    delivery.to("/odom", lambda _message, _arrived: None)(b"", 1.0)
    now[0] = PATIENCE + 1.0
    (said,) = silence.notices()
    assert "/pose" in said


def test_a_closed_wire_hands_nothing_over_and_takes_nothing() -> None:
    delivery, taken = Delivery(SilenceWatch()), []
    deliver = delivery.to("/odom", lambda message, _: taken.append(message))
    delivery.require_open()
    delivery.closed.set()
    deliver(b"late", 1.0)
    assert taken == []
    with pytest.raises(SettingsError, match="closed"):
        delivery.require_open()

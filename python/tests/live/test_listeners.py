# SPDX-License-Identifier: Apache-2.0
"""Whether somebody listens is looked at now and then, not at every message."""

from __future__ import annotations

from slipwise.live.ros_transport import LOOK_EVERY, Listeners


def test_a_listener_is_seen_at_the_next_look_and_one_look_serves_for_a_while() -> None:
    looks: list[str] = []
    heard = {"/a": 0, "/b": 1}
    clock = [100.0]

    def connections(topic: str) -> int:
        looks.append(topic)
        return heard[topic]

    listeners = Listeners(connections, now=lambda: clock[0])
    assert [listeners.on("/a"), listeners.on("/b")] == [False, True]
    heard.update({"/a": 2, "/b": 0})
    clock[0] += 0.9 * LOOK_EVERY
    assert [listeners.on("/a"), listeners.on("/b")] == [False, True]
    assert looks == ["/a", "/b"]
    clock[0] += 0.2 * LOOK_EVERY
    assert [listeners.on("/a"), listeners.on("/b")] == [True, False]
    assert looks == ["/a", "/b"] * 2

# SPDX-License-Identifier: Apache-2.0
"""Silence on a wanted topic is said once, after three seconds, with its reason."""

from __future__ import annotations

from slipwise.live.wires.silence import PATIENCE, PublisherSeen, SilenceWatch

ODOMETRY = "nav_msgs/msg/Odometry"
REFUSED = PublisherSeen("eProsima Fast DDS", ODOMETRY, matched=False)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def watch() -> tuple[SilenceWatch, Clock]:
    clock = Clock()
    made = SilenceWatch(clock)
    made.want("/odom", ODOMETRY)
    return made, clock


def test_a_refused_publisher_is_said_after_three_seconds_and_once() -> None:
    silence, clock = watch()
    silence.seen("/odom", [REFUSED])
    clock.now += PATIENCE - 0.1
    assert silence.notices() == []
    clock.now += 0.2
    (said,) = silence.notices()
    assert said.startswith("nothing has come on /odom for 3 s, though eProsima Fast DDS publishes it")
    assert all(way in said for way in ("rclpy", "fastdds.type_propagation=disabled"))
    clock.now += 10.0
    assert silence.notices() == []


def test_nothing_is_said_where_nobody_publishes_or_a_message_came() -> None:
    silence, clock = watch()
    clock.now += 10.0
    assert silence.notices() == []
    silence.seen("/odom", [REFUSED])
    silence.received("/odom")
    clock.now += 10.0
    assert silence.notices() == []


def test_patience_begins_anew_when_the_publisher_left() -> None:
    silence, clock = watch()
    silence.seen("/odom", [REFUSED])
    clock.now += 2.0
    silence.seen("/odom", [])
    clock.now += 2.0
    silence.seen("/odom", [REFUSED])
    clock.now += 2.0
    assert silence.notices() == []


def test_a_connected_publisher_may_have_nothing_to_tell() -> None:
    silence, clock = watch()
    silence.seen("/odom", [PublisherSeen("eProsima Fast DDS", ODOMETRY, matched=True)])
    clock.now += 4.0
    (said,) = silence.notices()
    assert "nothing to tell yet" in said
    assert "rclpy" not in said


def test_another_type_is_named() -> None:
    silence, clock = watch()
    silence.seen("/odom", [PublisherSeen("eProsima Fast DDS", "geometry_msgs/msg/PoseStamped", matched=True)])
    clock.now += 4.0
    assert silence.notices()[0].endswith("as geometry_msgs/msg/PoseStamped, not as nav_msgs/msg/Odometry")


def test_topics_that_nobody_wants_are_not_spoken_of() -> None:
    silence, clock = watch()
    silence.seen("/camera", [REFUSED])
    silence.received("/camera")
    clock.now += 4.0
    assert silence.notices() == []

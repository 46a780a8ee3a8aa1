# SPDX-License-Identifier: Apache-2.0
"""Finds the topics of a running robot: the ones given, or guessed as for a bag, and said."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from slipwise.live.cdr_reader import reader_of
from slipwise.live.first_messages import FirstMessages
from slipwise.live.one_rotation import rotation_of
from slipwise.live.ros_samples import FirstPoses
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import RosWire
from slipwise.logs.attitude import was_measured
from slipwise.logs.log import Floats
from slipwise.logs.messages import IMU, IMU_VALUES, NAV_SAT_FIX, POSE_VALUES, TF, Values
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import NONE, Topic
from slipwise.logs.topics import NOTHING_YET, Roles, choose_topics, weigh_topics

LOOK_EVERY = 0.25  # s
SETTLED = 1.5  # s for which what is guessed must stay the same: discovery takes its time
HEARD_WITHIN = 2.0  # s for which a message with a rotation is waited for
_LISTENED_TO = 3  # messages, of which one with a rotation is enough
SAY_AFTER = 3.0  # s without the topics, after which it is said what is waited for


def find_roles(
    wire: RosWire,
    options: LogOptions,
    say: Callable[[str], None],
    *,
    own: str = "",
) -> Roles:
    """Wait until the robot's topics are there, however long that takes, and choose among them.

    Args:
        wire: shows what is published.
        options: topics that are given; the others are guessed.
        say: called with what is waited for.
        own: the name below which the node publishes; such topics are never chosen.

    Raises:
        LogError: a given topic has the wrong type, or the guess is unclear.
    """
    begin = since = time.monotonic()
    before: frozenset[str] = frozenset()
    said = False
    while True:
        topics = [
            Topic(topic.name, topic.type, 1)
            for topic in wire.topics()
            if topic.type != TF and not (own and topic.name.startswith(f"{own}/"))
        ]
        now = time.monotonic()
        names = frozenset(topic.name for topic in topics)
        if names != before:
            before, since = names, now
        missing = _missing(topics, options)
        if not missing and (now > since + SETTLED or _all_given(options)):
            return choose_topics(topics, options)
        if missing and not said and now > begin + SAY_AFTER:
            said = True
            say(f"waiting for {missing}; topics now: {', '.join(sorted(names)[:8]) or 'none'}")
        time.sleep(LOOK_EVERY)


Use = Literal["command", "wheel", "pose", "orientation", "gyro", "other"]


def uses_of(roles: Roles) -> list[tuple[Use, Topic]]:
    """Return the topics from which is learned, and as what; one may be both wheels and pose."""
    fixes = roles.pose is not None and roles.pose.type == NAV_SAT_FIX
    turns = roles.pose is None or (fixes and roles.imu is None)
    found: tuple[tuple[Use, Topic | None], ...] = (
        ("command", roles.command),
        ("wheel", roles.wheel),
        ("orientation", roles.imu if roles.pose is not None else None),
        ("gyro", roles.gyro if turns else None),
        ("pose", roles.pose),
        *(("other", topic) for topic in roles.others),
    )
    return [(use, topic) for use, topic in found if topic is not None]


def with_oriented_imu(first: FirstMessages, roles: Roles, say: Callable[[str], None]) -> Roles:
    """Return the roles without an IMU beside poses where what it says first has no orientation.

    Args:
        first: messages of its topic.
        roles: that were chosen.
        say: called with what was found.
    """
    if roles.imu is None or roles.pose is None:
        return roles
    fixes = roles.pose.type == NAV_SAT_FIX
    angles = _first_angles(first, roles.imu, IMU_VALUES[IMU])
    if angles is not None and not any(angles):
        left = "its yaw rates are used" if fixes else "roll and pitch are not those of an IMU"
        say(f"{roles.imu.name} has no orientation: {left}")
        return replace(roles, imu=None)
    if angles is None:
        say(f"{roles.imu.name} is silent: {'headings wait' if fixes else 'roll and pitch wait'} for it")
    return roles


def first_poses(first: FirstMessages, roles: Roles, say: Callable[[str], None]) -> FirstPoses:
    """Return what the first poses show, and the IMU beside them.

    Args:
        first: messages of these topics.
        roles: that were chosen.
        say: called with what was found.
    """
    if roles.pose is None:
        return FirstPoses()
    oriented = _first_angles(first, roles.imu, IMU_VALUES[IMU]) if roles.imu is not None else None
    tilted = any(map(was_measured, _tilts(oriented)))
    if roles.pose.type == NAV_SAT_FIX:
        return FirstPoses(attitude=tilted)
    kind = POSE_VALUES[roles.pose.type]
    angles = _first_angles(first, roles.pose, lambda message: kind(message)[3:7])
    positions = bool(angles) and not any(angles or ())
    if positions:
        say(f"the quaternions of {roles.pose.name} are no rotations: positions only")
    tilts = all(map(was_measured, _tilts(angles)))
    return FirstPoses(positions, attitude=tilts or tilted, tilts=tilts)


def _tilts(angles: list[tuple[float, float, float] | None] | None) -> tuple[Floats, Floats]:
    """Return the rolls and the pitches, [N] each."""
    roll, pitch, _ = np.array([each for each in angles or () if each is not None]).reshape(-1, 3).T
    return roll, pitch


def _first_angles(
    first: FirstMessages, topic: Topic, values: Callable[[Any], Values]
) -> list[tuple[float, float, float] | None] | None:
    """Return (roll, pitch, yaw) of the first messages, or None for no rotation; None where too few come."""
    read, found = reader_of(topic.type, ros_types()), []
    for payload in first.of(topic.name, _LISTENED_TO, HEARD_WITHIN) or ():
        with contextlib.suppress(Exception):  # what cannot be read says nothing; the transport says so
            found.append(rotation_of(*values(read(payload))))
    return found or None


def only_positions(roles: Roles) -> bool:
    """Say whether poses are satellite fixes to which no IMU gives a heading."""
    return roles.pose is not None and roles.pose.type == NAV_SAT_FIX and roles.imu is None


def source_topics(roles: Roles) -> tuple[str, ...]:
    """Return the topics of all sources of poses, where there are several; the first's first."""
    if roles.pose is None or not roles.others:
        return ()
    return (roles.pose.name, *(topic.name for topic in roles.others))


def _all_given(options: LogOptions) -> bool:
    return options.pose_topic is not None and bool(options.command_topic or options.wheel_topic)


def _missing(topics: list[Topic], options: LogOptions) -> str:
    """Name what is not there yet; empty where a choice can be made."""
    names = {topic.name for topic in topics}
    given = (options.pose_topic, *options.other_pose_topics, options.command_topic, options.wheel_topic)
    absent = [name for name in given if name is not None and name != NONE and name not in names]
    if absent:
        return " and ".join(absent)
    problem = weigh_topics(topics, options).problem
    if problem is None or not problem.what.startswith(NOTHING_YET):
        return ""
    return "pose topic and a command or wheel topic beside it" if topics else "topics of a robot"

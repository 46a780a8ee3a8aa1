# SPDX-License-Identifier: Apache-2.0
"""Guesses which topic of a bag is the command, the measured pose and the wheel odometry."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from slipwise.errors import LogError
from slipwise.logs.messages import (
    COMMAND_TYPES,
    IMU,
    JOINT_STATE,
    NAV_SAT_FIX,
    ODOMETRY,
    POSE_STAMPED,
    POSE_TYPES,
    POSE_WITH_COVARIANCE,
    TF,
    TWIST_STAMPED,
    WHEEL_TYPES,
)
from slipwise.logs.options import LogOptions

# (pattern, score): the first pattern found in the lower-case topic name counts; a score below 0 excludes.
_COMMAND_NAMES = (
    (r"odom|measured|feedback|vrpn|mocap|gps|imu|wheel_vel|estimate|ground_truth|state", -1),
    (r"cmd_vel_out$", 6),
    (r"(^|/)cmd_vel$", 5),
    (r"cmd_vel_(unstamped|stamped)$", 4),
    (r"cmd_vel", 3),
    (r"(^|[/_])(cmd|command|drive|ackermann\w*)($|[/_])", 2),
)
_BEST = r"ground_?truth|gazebo|model_pose"
_CAMERAS = r"mocap|vicon|vrpn|optitrack|qualisys|natnet"
_SCANS = r"lidar|slam|localization|amcl|visual|(^|[/_])(lio|loam|particle|pf|zed|vio)"
_SATELLITES = r"gps|gnss|navsat|(^|[/_])(fix|ins)($|[/_])"
_DRIVE = r"velocity_controller|diff_drive|base_controller|drive_controller"
_FUSED = r"filtered|fused|(^|[/_])(ekf|ukf)"
_POSE_NAMES = (
    (r"goal|target|plan|setpoint|initialpose|command|cmd|waypoint", -1),
    (_BEST, 10),
    (_CAMERAS, 9),
    (r"rtk", 8),
    (r"icp", 7),
    (_SCANS, 6),
    (_SATELLITES, 5),
    (rf"wheel|encoder|{_DRIVE}", -1),
    (r"odom.*global|global.*odom", 4),
    (_FUSED, 2),
    (r"odom", -1),
)
_WHEEL_NAMES = (
    (rf"{_BEST}|{_CAMERAS}|rtk|icp|{_SCANS}|{_SATELLITES}", -1),
    (r"wheel|encoder", 6),
    (_DRIVE, 5),
    (rf"{_FUSED}|local|global", -1),
    (r"odom", 4),
    (r"joint_states?$", 2),
)
_TYPE_SCORE = {TWIST_STAMPED: 1, POSE_STAMPED: 1, ODOMETRY: 2, POSE_WITH_COVARIANCE: 3}


@dataclass(frozen=True)
class Topic:
    """A topic of a bag."""

    name: str
    type: str
    count: int


@dataclass(frozen=True)
class Roles:
    """The chosen topics."""

    pose: Topic
    command: Topic | None
    wheel: Topic | None
    imu: Topic | None
    guessed: tuple[str, ...]  # sentences about what was guessed


def choose_topics(topics: Sequence[Topic], options: LogOptions) -> Roles:
    """Choose the topics by name and type, or take the ones given.

    Raises:
        LogError: a given topic is not there or has the wrong type, or the guess is unclear.
    """
    live = {topic.name: topic for topic in topics if topic.count > 0}
    wheel = _choose(live, "wheel_topic", options.wheel_topic, WHEEL_TYPES, _WHEEL_NAMES)
    if (
        wheel is not None
        and wheel.type == JOINT_STATE
        and options.wheel_topic is None
        and not _wheel_sizes(options)
    ):
        wheel = None
    command = _choose(live, "command_topic", options.command_topic, COMMAND_TYPES, _COMMAND_NAMES)
    pose = _choose_pose(live, options)
    if pose is None:
        raise LogError("no topic with a measured pose", advice=_pose_advice(live))
    if command is None and wheel is None:
        raise LogError(
            "no topic with a command or with wheel speeds",
            advice=f"set command_topic or wheel_topic; {_listing(live)}",
        )
    imu = _imu(live, options) if pose.type == NAV_SAT_FIX else None
    guesses = (
        ("pose", pose, options.pose_topic),
        ("command", command, options.command_topic),
        ("wheel", wheel, options.wheel_topic),
        ("imu", imu, options.imu_topic),
    )
    notes = [
        f"{role} topic: {t.name} ({t.type.replace('/msg/', '/')})"
        for role, t, given in guesses
        if t and not given
    ]
    if options.pose_topic is None and re.search(_FUSED, pose.name.lower()):
        notes.append(f"{pose.name} is fused: it shows slip only if more than wheels and an IMU went into it")
    return Roles(pose, command, wheel, imu, tuple(notes))


def _choose_pose(live: Mapping[str, Topic], options: LogOptions) -> Topic | None:
    if options.pose_topic is not None:
        return _given(live, "pose_topic", options.pose_topic, POSE_TYPES)
    if options.pose_frame is not None or options.child_frame is not None:
        return next((t for t in live.values() if t.type == TF and not t.name.endswith("static")), None)
    kinds = tuple(kind for kind in POSE_TYPES if kind != TF)
    pose = _choose(live, "pose_topic", None, kinds, _POSE_NAMES)
    return pose or next((t for t in live.values() if t.type == TF and not t.name.endswith("static")), None)


def _choose(
    live: Mapping[str, Topic],
    option: str,
    given: str | None,
    kinds: tuple[str, ...],
    names: Sequence[tuple[str, int]],
) -> Topic | None:
    if given is not None:
        return _given(live, option, given, kinds)
    scored = [(_score(topic, names), topic) for topic in live.values() if topic.type in kinds]
    scored = [(score, topic) for score, topic in scored if score >= 0]
    if not scored:
        return None
    best = max(score for score, _ in scored)
    winners = [topic for score, topic in scored if score == best]
    if len(winners) > 1:
        listing = ", ".join(f"{topic.name} ({topic.count} messages)" for topic in winners)
        raise LogError(
            f"several topics could be the {option.removesuffix('_topic')}",
            advice=f"set {option} to one of {listing}",
        )
    return winners[0]


def _given(live: Mapping[str, Topic], option: str, name: str, kinds: tuple[str, ...]) -> Topic:
    topic = live.get(name) or live.get(f"/{name}")
    if topic is None:
        raise LogError(f"{option} {name} is not in the bag, or empty", advice=_listing(live))
    if topic.type not in kinds:
        expected = ", ".join(kind.split("/")[-1] for kind in kinds)
        raise LogError(f"{option} {name} is a {topic.type}", advice=f"it must be one of {expected}")
    return topic


def _score(topic: Topic, names: Sequence[tuple[str, int]]) -> int:
    """Return 10 times the name's score, a little more for types that say more."""
    for pattern, score in names:
        if re.search(pattern, topic.name.lower()):
            return 10 * score + _TYPE_SCORE.get(topic.type, 0) if score >= 0 else -1
    return _TYPE_SCORE.get(topic.type, 0)


def _wheel_sizes(options: LogOptions) -> bool:
    return options.wheel_radius is not None and options.track is not None


def _imu(live: Mapping[str, Topic], options: LogOptions) -> Topic | None:
    if options.imu_topic is not None:
        return _given(live, "imu_topic", options.imu_topic, (IMU,))
    found = [topic for topic in live.values() if topic.type == IMU]
    return next((topic for topic in found if "raw" not in topic.name), None)


def _pose_advice(live: Mapping[str, Topic]) -> str:
    odometry = [topic.name for topic in live.values() if topic.type == ODOMETRY]
    if odometry:
        return (
            f"{', '.join(odometry)} looks like wheel odometry, which cannot show its own slip; "
            "set pose_topic if its pose is measured from outside"
        )
    return f"set pose_topic; {_listing(live)}"


def _listing(live: Mapping[str, Topic]) -> str:
    if not live:
        return "the bag has no messages"
    shown = [
        f"{topic.name} ({topic.type.split('/')[-1]})" for topic in sorted(live.values(), key=lambda t: t.name)
    ]
    return "the bag has " + ", ".join(shown[:15]) + (", ..." if len(shown) > 15 else "")

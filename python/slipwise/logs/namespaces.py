# SPDX-License-Identifier: Apache-2.0
"""Whose topics these are, by their namespaces: those of another robot are not used for this one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

#: Parts of a topic's name that name a device or a program, and no robot.
_DEVICE = re.compile(
    r"mocap|vicon|vrpn|optitrack|qualisys|natnet|ground_?truth|gazebo|model|rtk|icp|lidar|slam|locali[sz]|amcl|"
    r"visual|lio|loam|particle|^pf$|zed|vio|gps|gnss|navsat|^fix$|^ins$|odom|wheel|encoder|drive|control|"
    r"filter|fused|ekf|ukf|cmd|command|joy|teleop|mux|^nav|plan|move_base|base|platform|sensor|state|estimat|"
    r"global|local|camera|imu|hardware|hw|vehicle|chassis|mobile|actuator|perception|world|map|pose|track|"
    r"ublox|piksi|mavros|autoware|^robot$|^ros|^sys",
    re.IGNORECASE,
)
_NUMBERED = re.compile(r"^(.*?)[_-]?(\d+|[a-z])$", re.IGNORECASE)  # robot_2, tb3_0, r1, robot_b


def robot_of(topic: str) -> str:
    """Return the namespace that names a robot, the first that names no device; empty where there is none."""
    return next((part for part in _namespaces(topic) if not _DEVICE.search(part)), "")


def _namespaces(topic: str) -> list[str]:
    return topic.strip("/").split("/")[:-1]


def others_topics(candidates: Mapping[str, Sequence[str]], given: Mapping[str, str]) -> dict[str, str]:
    """Return which topics are another robot's, and why, by name.

    A robot is known by the pose or the command that is given, or by topics for two roles at least.

    Args:
        candidates: names of topics that could take each role.
        given: topics that the user names for roles; they are never another robot's.
    """
    own = _own_robot(candidates, given)
    if not own:
        return {} if given else _siblings(candidates)
    foreign = {}
    for found in candidates.values():
        others = any(own in _namespaces(name) for name in found)
        for name in set(found) - set(given.values()):
            robot = robot_of(name)
            if not robot or own in _namespaces(name):
                continue
            if _namespaces(name)[0] == robot or _alike(robot, own) or others:
                foreign[name] = f"it is of {robot}, not of {own}"
    return foreign


def _own_robot(candidates: Mapping[str, Sequence[str]], given: Mapping[str, str]) -> str:
    """Return the name of the robot; empty where it is not known."""
    for role in ("pose", "command"):
        if role in given and robot_of(given[role]):
            return robot_of(given[role])
    robots = [robot for found in candidates.values() for robot in {robot_of(name) for name in found} if robot]
    several = {robot for robot in robots if robots.count(robot) > 1}
    return several.pop() if len(several) == 1 else ""


def _siblings(candidates: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Where the commands are of one numbered robot and the wheels of another, the wheels are not taken."""
    commands, wheels = (
        {robot_of(name) for name in candidates.get(role, ())} for role in ("command", "wheel")
    )
    if len(commands) != 1 or "" in commands:
        return {}
    (own,) = commands
    return {
        name: f"it is of {robot}, not of {own}"
        for name in candidates.get("wheel", ())
        if own not in wheels and (robot := robot_of(name)) and _alike(robot, own)
    }


def _alike(first: str, second: str) -> bool:
    """Say whether two names differ in their number alone."""
    both = [_NUMBERED.match(name) for name in (first, second)]
    return all(both) and both[0][1].lower() == both[1][1].lower() and first != second  # type: ignore[index]

# SPDX-License-Identifier: Apache-2.0
"""Grouping path segments by commanded speed and curvature; turns in place by their yaw rate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np

from slipwise.errors import LogError, SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady.paths import SteadyPath


@dataclass(frozen=True)
class GroupRules:
    """Which commands are alike. A segment joins the first group whose first segment is within these."""

    speed: float = 0.02  # m/s
    curvature: float = 0.02  # 1/m
    yaw_rate: float = 0.02  # rad/s, of turns in place
    turn_speed: float = 0.05  # m/s; at or below this a hold is a turn in place and has no curvature


@dataclass(frozen=True, eq=False)
class SteadyGroup:
    """Segments of (nearly) one command; its means over the segments."""

    v: float  # m/s
    vy: float  # m/s
    omega: float  # rad/s
    curvature: float | None  # 1/m; None: a turn in place, where speed is zero and curvature undefined
    paths: tuple[SteadyPath, ...]

    def __len__(self) -> int:
        return len(self.paths)

    @property
    def overlap(self) -> float:
        """How many segments share each datum; covariances of the group grow by it."""
        return max(path.overlap for path in self.paths)

    @property
    def name(self) -> str:
        """A few words for tables and messages."""
        if self.curvature is None:
            return f"turn in place at {self.omega:.3g} rad/s"
        return f"{self.v:.3g} m/s, curvature {self.curvature:.3g} 1/m"

    def core(self) -> list[_thesis.SteadySegment]:
        """Return the core's segments, each with its own command.

        Raises:
            LogError: a segment is there twice: it would count as two that agree.
        """
        seen: set[tuple[float, bytes, bytes]] = set()
        for path in self.paths:
            key = (path.start, path.times.tobytes(), path.poses.tobytes())
            if key in seen:
                raise LogError(
                    f"segments are duplicates, such as that at {path.start:.3f} s of run {path.run}",
                    where=self.name,
                    advice="give each log once",
                )
            seen.add(key)
        return [path.core() for path in self.paths]


def group_paths(paths: Iterable[SteadyPath], rules: GroupRules = GroupRules()) -> tuple[SteadyGroup, ...]:
    """Group segments, ordered by turns in place first, then speed and curvature.

    Raises:
        SettingsError: a rule is negative or not finite.
    """
    for field in fields(rules):
        value = getattr(rules, field.name)
        if not (np.isfinite(value) and value >= 0):
            raise SettingsError(f"{field.name} is {value}", where=field.name, advice="give zero or more")
    gathered: list[tuple[tuple[bool, float, float], list[SteadyPath]]] = []
    for path in paths:
        key = _key(path, rules)
        for other, members in gathered:
            if _alike(key, other, rules):
                members.append(path)
                break
        else:
            gathered.append((key, [path]))
    ordered = sorted(gathered, key=lambda item: (not item[0][0], item[0][1], item[0][2]))
    return tuple(_group(key[0], members) for key, members in ordered)


def _key(path: SteadyPath, rules: GroupRules) -> tuple[bool, float, float]:
    """(turn in place, speed, curvature or yaw rate)."""
    v, vy, omega = path.command
    speed = float(np.hypot(v, vy))
    if speed <= rules.turn_speed:
        return True, 0.0, omega
    signed = float(np.copysign(speed, v)) if v != 0 else speed
    return False, signed, omega / signed


def _alike(a: tuple[bool, float, float], b: tuple[bool, float, float], rules: GroupRules) -> bool:
    turn = rules.yaw_rate if a[0] else rules.curvature
    return a[0] == b[0] and abs(a[1] - b[1]) <= rules.speed and abs(a[2] - b[2]) <= turn


def _group(turn_in_place: bool, members: list[SteadyPath]) -> SteadyGroup:
    v, vy, omega = (float(value) for value in np.mean([path.command for path in members], axis=0))
    curvature = None if turn_in_place else float(np.mean([_signed_curvature(path) for path in members]))
    return SteadyGroup(v, vy, omega, curvature, tuple(members))


def _signed_curvature(path: SteadyPath) -> float:
    v, vy, omega = path.command
    speed = float(np.hypot(v, vy))
    return omega / (float(np.copysign(speed, v)) if v != 0 else speed)

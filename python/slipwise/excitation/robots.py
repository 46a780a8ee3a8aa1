# SPDX-License-Identifier: Apache-2.0
"""Robots drawn from the knowledge before a drive, and how far they stray on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.excitation.knowledge import Knowledge
from slipwise.planning.start import Start

Floats = NDArray[np.float64]

PERIOD = 0.1  # s, of the rollouts
TOGETHER = 500  # robots whose paths are held at once
THREE_SIGMA = 2.782  # normal quantile of 99.73 %, which three standard deviations hold in one dimension


@dataclass(frozen=True, eq=False)
class Robots:
    """Drawn robots, each a program of the core."""

    programs: tuple[_core.RolloutProgram, ...]
    sideways: bool = False  # whether they are commanded sideways, too

    def paths(self, commands: Floats) -> Floats:
        """Return where each robot comes under one sequence of commands [K, 3]: [S, 3, K] m, m, rad."""
        paths, roll = np.empty((len(self.programs), 3, len(commands), 1)), self._roller()
        for program, path in zip(self.programs, paths, strict=True):
            roll(program, commands[None], path)
        return paths[..., 0]

    def box(self, commands: Floats, room: Floats | None = None) -> Floats | None:
        """Return least and largest x, y [4] m that any robot reaches under a sequence of commands [K, 3].

        None where they need more than a room [2] m: once some robots do, others do not drive.
        """
        box, roll = np.zeros(4), self._roller()  # all begin at the start
        paths = np.empty((min(TOGETHER, len(self.programs)), 3, len(commands), 1))
        for first in range(0, len(self.programs), TOGETHER):
            programs = self.programs[first : first + TOGETHER]
            for program, path in zip(programs, paths, strict=False):
                roll(program, commands[None], path)
            reached = paths[: len(programs), :2]
            box[::2] = np.minimum(box[::2], reached.min(axis=(0, 2, 3)))
            box[1::2] = np.maximum(box[1::2], reached.max(axis=(0, 2, 3)))
            if room is not None and not fits(box[None], room)[0]:
                return None
        return box

    def inside(self, commands: Floats, room: Floats) -> tuple[NDArray[np.bool_], Floats]:
        """Return which sequences of commands [N, K, 3] keep the robots within a room, and where they end.

        Args:
            commands: what every robot is commanded.
            room: width and depth [2] m; where the room stands about the start is free.

        Returns:
            whether all robots fit [N], and how far from the start the farthest one ends [N] m, where they do.
        """
        box, end = self._boxes(commands, room)
        return fits(box, room), end

    def _roller(self) -> Callable[[_core.RolloutProgram, Floats, Floats], None]:
        """Return what fills a path [3, K, N] from rest in the origin under commands [N, K, 3]."""
        start = _core.StartList(np.zeros((1, 6)), np.zeros((1, 0, 3)))
        level = _core.instruction_levels()[-1]

        def roll(program: _core.RolloutProgram, commands: Floats, path: Floats) -> None:
            given = commands if self.sideways else commands[..., ::2]
            _core.rollout_batch(program, given, start, path, None, None, None, 1, level, None)

        return roll

    def _boxes(self, commands: Floats, room: Floats) -> tuple[Floats, Floats]:
        """Return boxes [N, 4] and farthest ends [N]; a sequence that leaves the room is not followed on."""
        box, end = np.zeros((len(commands), 4)), np.zeros(len(commands))  # all begin at the start
        left, roll = np.arange(len(commands)), self._roller()
        for program in self.programs:
            path = np.empty((3, commands.shape[1], len(left)))
            roll(program, commands[left], path)
            lowest, highest = path[:2].min(axis=1), path[:2].max(axis=1)
            box[left, ::2] = np.minimum(box[left, ::2], lowest.T)
            box[left, 1::2] = np.maximum(box[left, 1::2], highest.T)
            end[left] = np.maximum(end[left], np.hypot(path[0, -1], path[1, -1]))
            left = left[fits(box[left], room)]
            if len(left) == 0:
                break
        return box, end


def fits(box: Floats, room: Floats) -> NDArray[np.bool_]:
    """Whether boxes [N, 4] are no wider and deeper than the room [2] m."""
    return np.asarray((box[:, 1] - box[:, 0] <= room[0]) & (box[:, 3] - box[:, 2] <= room[1]))


def drawn_robots(knowledge: Knowledge, count: int, *, seed: int, least: float = 0.0) -> Robots:
    """Draw robots from the spread of the knowledge, a normal distribution or several.

    Args:
        knowledge: mean and covariance of the parameters.
        count: robots.
        seed: of the draw.
        least: part of the robots that each kind gets at least, where there are several; rare ones are then
            drawn more often than they are likely.
    """
    if not knowledge.kinds:
        return _robots(knowledge, np.random.default_rng(seed).standard_normal((count, len(knowledge.mean))))
    shares = np.maximum([weight for weight, _ in knowledge.kinds], least)
    numbers = np.random.default_rng(seed).multinomial(count, shares / shares.sum()).tolist()
    return _together(
        drawn_robots(kind, number, seed=seed + place)
        for place, ((_, kind), number) in enumerate(zip(knowledge.kinds, numbers, strict=True), start=1)
    )


def edge_robots(knowledge: Knowledge, count: int, *, seed: int) -> Robots:
    """Draw robots from the edge of the region that holds 99.73 % of them, and the mean robot.

    In one dimension that region is three standard deviations wide. Several kinds give as many robots each.
    """
    if knowledge.kinds:
        each = math.ceil(count / len(knowledge.kinds))
        parts = (edge_robots(kind, each, seed=seed + k) for k, (_, kind) in enumerate(knowledge.kinds))
        return _together(parts)
    size = len(knowledge.mean)
    drawn = np.random.default_rng(seed).standard_normal((count, size))
    if size:
        drawn *= edge_radius(size) / np.linalg.norm(drawn, axis=1, keepdims=True)
    return _robots(knowledge, np.vstack((np.zeros(size), drawn)))


def edge_radius(size: int) -> float:
    """Return the Mahalanobis radius of the region that holds 99.73 % (Wilson and Hilferty 1931)."""
    part = 2.0 / (9.0 * size)
    return math.sqrt(size * (1.0 - part + THREE_SIGMA * math.sqrt(part)) ** 3)


def _together(parts: Iterable[Robots]) -> Robots:
    robots = list(parts)
    programs = tuple(program for part in robots for program in part.programs)
    return Robots(programs, any(part.sideways for part in robots))


def _robots(knowledge: Knowledge, drawn: Floats) -> Robots:
    values, vectors = np.linalg.eigh(knowledge.spread)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    parameters = knowledge.mean + drawn @ root.T
    motion, sideways = knowledge.motion, knowledge.sideways
    setting = (PERIOD, Start().ground, knowledge.limits, None, sideways)
    return Robots(tuple(_core.RolloutProgram(motion, row, *setting) for row in parameters), sideways)

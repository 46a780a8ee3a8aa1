# SPDX-License-Identifier: Apache-2.0
"""Looks for the next moves worth driving now and then, in pieces of work where no sample waits."""

from __future__ import annotations

import math
import time
from collections.abc import Generator

import numpy as np

from slipwise.errors import SlipwiseError
from slipwise.excitation import CommandSpace, NextMoves, choose_next_moves, knowledge_of, prior_knowledge
from slipwise.excitation.information import PoseStd
from slipwise.live.gates import REVERSE
from slipwise.live.outputs import Floats, MoveNow, NextMovesNow, ParameterNow, SureNow
from slipwise.live.samples import Twist
from slipwise.models import Model
from slipwise.models.parameter_table import physical_name
from slipwise.planning import limits_of

COUNT = 3  # moves
LOOK_EVERY = 10.0  # s of the wall clock between two looks, at least: a person drives no move sooner
LEVELS = 5  # of speed and yaw rate from zero to the fastest seen
AT_ONCE = 0.001  # s of work, after which it is looked whether a sample waits; a piece more is begun before
SHARE = 0.01  # of the time at most that is worked
TURNS = 0.1  # rad/s, from which on a robot counts as turning
SLOWEST = 0.05  # m/s, below which it turns on the spot

_Work = Generator[None, None, NextMoves]


class Turning:
    """The tightest turn among what the robot was given: a car is not to be asked to turn on the spot."""

    def __init__(self) -> None:
        self.curvature = 0.0  # 1/m

    def take(self, twist: Twist) -> None:
        """Take what the robot was given."""
        turn = abs(twist.omega)
        if TURNS < turn < math.inf:
            self.curvature = max(self.curvature, turn / max(abs(twist.v), SLOWEST))


class MoveAdviser:
    """Works in pieces of a millisecond or two, so that no sample waits for longer.

    Args:
        reverse: whether driving in reverse is learned; else no move does.
        turning: of what the robot was given.
    """

    def __init__(self, *, reverse: bool, turning: Turning) -> None:
        self._reverse, self._turning = reverse, turning
        self._work: _Work | None = None
        self._seen: Model | None = None
        self._next = -math.inf
        self._spent = 0.0  # s of this look so far

    def due(self, model: Model | None, now: float) -> bool:
        """Whether there is something to do at a time of the wall clock [s]."""
        if model is None:
            return False
        return self._work is not None or (model is not self._seen and now >= self._next)

    def advance(
        self, t: float, model: Model, parameters: tuple[ParameterNow, ...], *, whole: bool = False
    ) -> NextMovesNow | None:
        """Do a piece of the work, or all that is left; return the moves where they are found.

        Args:
            t: stamp of the newest sample [s].
            model: the newest; a look that has begun goes on with its own.
            parameters: as they are shown.
            whole: do not stop before the end.
        """
        begin = time.monotonic()
        try:
            if self._work is None:
                self._seen, self._spent = model, 0.0
                self._work = self._look(model)
            while True:
                next(self._work)
                if not whole and time.monotonic() - begin >= AT_ONCE:
                    self._spent += time.monotonic() - begin
                    return None
        except StopIteration as done:
            found = _shown(t, done.value, parameters)
        except (SlipwiseError, np.linalg.LinAlgError) as problem:
            found = NextMovesNow(t, (), (), parameters, f"no moves can be found: {problem}")
        except _NotYetError as reason:
            found = NextMovesNow(t, (), (), parameters, str(reason))
        now = time.monotonic()
        self._work, self._spent = None, self._spent + now - begin
        self._next = now + max(LOOK_EVERY, self._spent / SHARE)
        return found

    def _look(self, model: Model) -> _Work:
        if model.car is not None:
            raise _NotYetError("throttle and steering are commanded here, no speeds")
        commands = self._commands(model)
        yield
        if model.vector.rows:
            knowledge = knowledge_of(model)
            kept = model.vector.rows[: len(knowledge.mean)]
            prior_std = np.array([each.prior_std for each in kept])
        else:
            speed, _, yaw_rate = np.abs(commands).max(axis=0).tolist()
            knowledge = prior_knowledge(CommandSpace(speed, yaw_rate))
            prior_std = np.sqrt(np.diag(knowledge.covariance))
        yield
        return (yield from choose_next_moves(knowledge, prior_std, commands, COUNT))

    def _commands(self, model: Model) -> Floats:
        """Return what the robot may be asked, [N, 3] (v, vy, omega): no faster, no tighter than it drove.

        Forwards and in reverse by themselves; where it never went, it is asked for the slowest speed alone.
        """
        span = model.content.range
        if max(map(abs, span.speed)) < SLOWEST or self._turning.curvature == 0.0:
            raise _NotYetError("drive a slow curve first: the robot has not driven and turned yet")
        limits = limits_of(model)
        found = CommandSpace(limits.speed, limits.yaw_rate).grid(LEVELS)
        v, _, omega = np.abs(found).T
        kept = (omega <= 1.001 * self._turning.curvature * np.maximum(v, SLOWEST)) & (v + omega > 0.0)
        careful = 1.001 * limits.speed / (LEVELS - 1)
        kept &= (found[:, 0] >= min(span.speed[0], -careful)) & (found[:, 0] <= max(span.speed[1], careful))
        if not self._reverse:
            kept &= found[:, 0] > REVERSE
        found = found[kept]
        order = np.lexsort((np.abs(found[:, 2]), found[:, 0] < 0.0))  # forwards and straight first
        return np.ascontiguousarray(found[order])


class _NotYetError(Exception):
    """Why there are no moves."""


def _shown(t: float, found: NextMoves, parameters: tuple[ParameterNow, ...]) -> NextMovesNow:
    std = PoseStd()
    names = (("yaw", "rad", std.yaw), ("position", "m", std.position))
    sure = tuple(
        SureNow(name, unit, prior, now, target)
        for (name, unit, target), prior, now in zip(names, found.prior, found.now, strict=True)
    )
    moves = tuple(
        MoveNow(m.move.v, m.move.omega, m.move.hold, m.yaw, m.position, physical_name(m.teaches))
        for m in found.moves
    )
    return NextMovesNow(t, moves, sure, parameters)

# SPDX-License-Identifier: Apache-2.0
"""What moves tell about the parameters, and how sure the worst prediction is then (G-optimality)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.excitation.knowledge import Knowledge
from slipwise.excitation.moves import Move, start_times

Floats = NDArray[np.float64]

REST = 30.0  # s of standing before a drive, by when any lag has died away
ROWS = 256  # of information matrices that are judged at once, to bound the memory


@dataclass(frozen=True)
class PoseStd:
    """Standard deviation of the measured motion of a move."""

    position: float = 0.05  # m, in x and in y
    yaw: float = 0.03  # rad

    @property
    def vector(self) -> Floats:
        """The same for (x, y, yaw)."""
        return np.array([self.position, self.position, self.yaw])


def move_jacobians(knowledge: Knowledge, moves: Sequence[Move], first: float = 0.0) -> list[list[Floats]]:
    """Return per move the derivatives [3, parameters] of the motions that are measured of it.

    That is the motion until the command ends and, where lag is to be learned and the robot stands then, the
    motion until the next move begins: what comes after the command tells lag from slip.

    Args:
        knowledge: where to linearise.
        moves: one after the other, the robot at rest before the first.
        first: when the first begins [s].
    """
    starts = start_times(moves, first)
    history = _history(knowledge, moves, starts)
    result = []
    for move, begin in zip(moves, starts.tolist(), strict=False):
        ends = [begin + move.hold]
        if knowledge.motion.actuator_size and move.pause > 0.0:
            ends.append(begin + move.seconds)
        result.append([_jacobian(knowledge, history, begin, end) for end in ends])
    return result


def prediction_jacobians(knowledge: Knowledge, commands: Floats, horizon: float) -> Floats:
    """Return the derivatives [N, 3, parameters] of predictions from rest.

    They are under held commands (v, vy, omega) [N, 3].
    """
    return np.array(
        [
            move_jacobians(knowledge, [Move(v, omega, horizon, 0.0, vy)])[0][0]
            for v, vy, omega in commands.tolist()
        ]
    )


def information(jacobians: Iterable[Floats], std: PoseStd) -> Floats:
    """Return what measured motions tell, [parameters, parameters]: the sum of J^T R^-1 J."""
    scaled = [jacobian / std.vector[:, None] for jacobian in jacobians]
    return np.asarray(sum(part.T @ part for part in scaled))


def prior_information(knowledge: Knowledge) -> Floats:
    """Return the inverse of the covariance; exact values stay exact."""
    std = np.sqrt(np.diag(knowledge.covariance))
    scale = np.where(std > 0.0, std, 1.0)
    correlation = knowledge.covariance / np.outer(scale, scale)
    exact = np.where(std > 0.0, 0.0, 1e-12)
    return np.asarray(np.linalg.inv(correlation + np.diag(exact)) / np.outer(scale, scale))


@dataclass(frozen=True, eq=False)
class WorstPrediction:
    """The least sure of many predictions."""

    jacobians: Floats  # [N, 3, parameters] of the predictions

    def sigmas(self, information: Floats) -> tuple[float, float]:
        """Return the largest standard deviation of yaw [rad] and of a position, along its worst axis [m]."""
        yaw, position = self._variances(information[None])
        return float(np.sqrt(yaw[0])), float(np.sqrt(position[0]))

    def scores(self, information: Floats) -> Floats:
        """Return the logarithm of the worst yaw's variance times the worst position's, [M].

        Both count alike whatever their units: halving one is worth halving the other.

        Args:
            information: [M, parameters, parameters].
        """
        parts = [self._variances(information[i : i + ROWS]) for i in range(0, len(information), ROWS)]
        return np.concatenate([np.log(yaw) + np.log(position) for yaw, position in parts])

    def _variances(self, information: Floats) -> tuple[Floats, Floats]:
        """Return the largest variance of yaw and of a position [M] each."""
        covariance = np.linalg.inv(information)
        count, parameters = len(self.jacobians), covariance.shape[-1]
        rows = self.jacobians.reshape(-1, parameters)
        spread = (rows @ covariance).reshape(-1, count, 3, parameters)  # of each prediction with parameters
        xx, yy, yaw = (np.einsum("mnp,np->mn", spread[:, :, i], self.jacobians[:, i]) for i in range(3))
        xy = np.einsum("mnp,np->mn", spread[:, :, 0], self.jacobians[:, 1])
        largest = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        return yaw.max(axis=1), largest.max(axis=1)


def _history(knowledge: Knowledge, moves: Sequence[Move], starts: Floats) -> _core.InputHistory:
    rows = [(float(starts[0]) - REST, 0.0, 0.0, 0.0)]
    for move, begin in zip(moves, starts.tolist(), strict=False):
        rows.append((begin, move.v, move.vy, move.omega))
        if move.pause > 0.0:
            rows.append((begin + move.hold, 0.0, 0.0, 0.0))
    t, v, vy, omega = (np.ascontiguousarray(column) for column in np.array(rows).T)
    return knowledge.driven(_core.InputHistory(t, v, vy, omega))


def _jacobian(knowledge: Knowledge, history: _core.InputHistory, begin: float, end: float) -> Floats:
    segment = _core.Segment(begin, end, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    at = _core.linearize_segment(knowledge.motion, knowledge.mean, history, segment)
    return np.array(at.by_parameter)

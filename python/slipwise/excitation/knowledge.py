# SPDX-License-Identifier: Apache-2.0
"""Knowledge of a robot before the drive: a learned model's posterior, or the learner's prior."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.excitation.command_space import CommandSpace
from slipwise.models.axes import axes_of
from slipwise.models.model import Model

Floats = NDArray[np.float64]

BASIS = "odd-even-10"
SPREAD_SECONDS = 2.0  # over which a model's slip is averaged where robots are drawn from it


@dataclass(frozen=True, eq=False)
class Knowledge:
    """Parameters and how sure they are."""

    motion: _core.MotionModel
    mean: Floats  # [parameters]
    covariance: Floats  # [parameters, parameters] that a drive is to shrink
    spread: Floats  # [parameters, parameters] of the robots that may turn up, the slip disturbance included
    limits: _core.CommandLimits | None = None  # of the drive, in front of its lag
    sideways: bool = False  # whether it is commanded sideways, too
    #: Robots that may turn up, where these are of several kinds: each kind's weight and knowledge.
    kinds: tuple[tuple[float, Knowledge], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(info.name for info in self.motion.parameters)

    def spread_by(self, factor: float) -> Knowledge:
        """Return the same where robots differ so many times as much from the expected one; 0: not at all."""
        kinds = tuple((weight, kind.spread_by(factor)) for weight, kind in self.kinds)
        return replace(self, spread=factor**2 * self.spread, kinds=kinds)

    def driven(self, history: _core.InputHistory) -> _core.InputHistory:
        """Return what reaches the actuator of these commands."""
        if self.limits is None:
            return history
        return _core.limited_inputs(history, self.limits, _core.RAMP_PIECE)


def prior_knowledge(space: CommandSpace, *, basis: str = BASIS, dynamics: bool = True) -> Knowledge:
    """Return what the learner assumes before any data, at the speeds of a command space.

    Every slip term may explain 30 % of the motion at these speeds (one standard deviation, as in learning).

    Args:
        space: limits of the commands.
        basis: a named slip basis.
        dynamics: lag and delay of the drive are parameters, too.

    Raises:
        SettingsError: there is no such basis.
    """
    try:
        motion = _core.MotionModel(_core.named_basis(basis), dynamics, False)
    except ValueError as problem:
        raise SettingsError(str(problem), where="basis") from problem
    prior = _core.prior_estimate(motion, space.speed, space.yaw_rate, _core.PriorSettings())
    covariance = np.array(prior.covariance)
    return Knowledge(motion, np.array(prior.mean), covariance, covariance)


def knowledge_of(model: Model) -> Knowledge:
    """Return what a learned model knows of base_link's motion, wherever its pose sensor sits.

    Raises:
        ModelError: it takes throttle and steering, or has a force that is fixed to the map: where the robot
            looks is not known before a drive.
    """
    model.refuse_throttle("designed drives")
    model.refuse_heading("designed drives")
    body = model.body
    spread = body.covariance_over(SPREAD_SECONDS)
    sideways = axes_of(body).sideways
    return Knowledge(body.motion, body.mean, body.covariance, spread, body.limits, sideways)

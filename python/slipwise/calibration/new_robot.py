# SPDX-License-Identifier: Apache-2.0
"""What a fleet knows of its next robot, as a drive is designed for it: parameters of the whole motion."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.calibrate import JUDGING_HORIZONS
from slipwise.calibration.from_prior import KnownFleet, begin_from, start_of
from slipwise.calibration.learned_log import new_learner
from slipwise.calibration.learner import STRUCTURES
from slipwise.calibration.log_knowledge import robot_model
from slipwise.calibration.settings import Settings
from slipwise.errors import ModelError
from slipwise.excitation import Knowledge
from slipwise.models.fleet_prior import StartPrior


def new_robot_knowledge(prior: KnownFleet) -> Knowledge:
    """Return mean and covariance of a robot of the fleet before its first log, over the terms of all bases.

    It is what a learner that begins with the prior knows at first: the weighted mean of the bases, with what
    they disagree about in the covariance. Robots that may turn up slip by one basis each.

    Args:
        prior: of the robot's type, of commands.

    Raises:
        ModelError: the prior is of wheel speeds, of other bases, or of too few robots.
    """
    start = start_of(prior)
    if start.input != "command":
        raise ModelError(
            f"the prior is of {start.input}s, and says nothing of the lag behind commands",
            where=str(prior.path),
            advice="run `slipwise fleet` on logs with commands",
        )
    learner = new_learner((), start.input, Settings(), JUDGING_HORIZONS)
    wheels = start.structure == "cascaded"  # without them, the learner would not explain motion so
    begin_from(learner, start, start.input, wheels=wheels, where=str(prior.path))
    posterior = learner.model().motion
    covariance = np.array(posterior.estimate.covariance)
    mean = np.array(posterior.estimate.mean)
    return Knowledge(posterior.model, mean, covariance, covariance, kinds=robots_by_basis(prior))


def robots_by_basis(prior: KnownFleet) -> tuple[tuple[float, Knowledge], ...]:
    """Return what the prior says of a robot that slips by one basis alone, with the basis's weight.

    Robots drawn of these, a basis by its weight and then its parameters, are those that the file describes.

    Raises:
        ModelError: as for `new_robot_knowledge`.
    """
    start = start_of(prior)
    learner = new_learner((), start.input, Settings(), JUDGING_HORIZONS)
    hypotheses = learner.settings.hypotheses
    found = []
    for basis in hypotheses.bases:
        if basis.name in start.bases and len(start.bases[basis.name].mean) == basis.size:
            motion = robot_model(STRUCTURES.index(start.structure), hypotheses, basis)
            found.append((start.bases[basis.name].weight, _of_basis(start, basis.name, motion)))
    return tuple(found)


def _of_basis(start: StartPrior, name: str, motion: _core.MotionModel) -> Knowledge:
    slip, robot = start.bases[name], start.robot
    terms, size = len(slip.mean), len(slip.mean) + len(robot.mean)
    covariance = np.zeros((size, size))
    covariance[:terms, :terms] = np.array(slip.covariance).reshape(terms, terms)
    covariance[terms:, terms:] = np.array(robot.covariance).reshape(size - terms, size - terms)
    return Knowledge(motion, np.array([*slip.mean, *robot.mean]), covariance, covariance)

# SPDX-License-Identifier: Apache-2.0
"""What one log says of its robot in the terms of every basis, as a fleet puts logs together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.learner import BASELINE, CASCADED, DIRECT, JOINT, LIMITS, STRUCTURES
from slipwise.calibration.settings import Settings

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LearnedNormal:
    """Parameters after a log, and before it."""

    mean: Floats  # [P]
    covariance: Floats  # [P, P]
    prior_mean: Floats  # [P]
    prior_std: Floats  # [P], of independent parameters


@dataclass(frozen=True, eq=False)
class BasisKnowledge:
    """Slip in the terms of one basis, whatever the robot's lags may be."""

    slip: LearnedNormal
    weight: float  # of the basis
    noise_scale: Floats  # [3]


@dataclass(frozen=True, eq=False)
class StructureKnowledge:
    """What one way to explain motion learned."""

    speeds: tuple[float, float]  # m/s, rad/s, of the prior
    bases: dict[str, BasisKnowledge]
    robot_names: tuple[str, ...]
    # None where another structure was kept, and this one has an actuator of its own.
    robot: LearnedNormal | None


@dataclass(frozen=True, eq=False)
class LogKnowledge:
    """What was learned of one log, by structure."""

    input: str  # "command" or "wheel"
    kept: str  # structure that explained the log best, of those with slip
    structures: dict[str, StructureKnowledge]


def knowledge_of(learner: _core.MotionLearner, input_name: str, settings: Settings) -> LogKnowledge | None:
    """Return what a learner knows after a log; None where nothing was learned.

    Args:
        learner: that has learned a log.
        input_name: "command" or "wheel".
        settings: that it learned with.
    """
    model = learner.model()
    if model.segments == 0:
        return None
    kept = JOINT if model.slip.structure in (BASELINE, LIMITS) else model.slip.structure
    found = {}
    for structure in (JOINT, CASCADED, DIRECT):
        known = _structure(learner, structure, settings, model.slip)
        if known is not None:
            found[STRUCTURES[structure]] = known
    return LogKnowledge(input_name, STRUCTURES[kept], found) if STRUCTURES[kept] in found else None


def _structure(
    learner: _core.MotionLearner, structure: int, settings: Settings, best: _core.MotionPosterior
) -> StructureKnowledge | None:
    now = learner.slip_now(structure)
    if now is None:
        return None
    v, omega = now.prior_speeds
    slips = [slip for slip in now.memory.slips if len(slip.mean)]
    size = len(now.state.estimate.mean) - (len(slips[0].robot) if slips else 0)
    robot = np.array(now.state.estimate.covariance)[size:, size:]
    bases = {basis.name: basis for basis in learner.settings.hypotheses.bases}
    known = {}
    for name, slip, weight in zip(now.memory.bases, now.memory.slips, now.memory.weights, strict=True):
        by_robot = np.array(slip.by_robot).reshape(len(slip.mean), len(slip.robot))
        covariance = np.array(slip.covariance) + by_robot @ robot @ by_robot.T
        std = np.array(
            _core.slip_prior_std(bases[name], v, omega, settings.filter_settings().prior.slip_fraction)
        )
        learned = LearnedNormal(np.array(slip.mean), covariance, np.zeros(len(std)), std)
        known[name] = BasisKnowledge(learned, float(weight), np.array(slip.noise_scale))
    motion = robot_model(structure, learner.settings.hypotheses)
    names, learned_robot = _robot((now, structure, motion), settings, best)
    return StructureKnowledge((v, omega), known, names, learned_robot)


def robot_model(
    structure: int, hypotheses: _core.HypothesisSettings, slip: _core.Basis | None = None
) -> _core.MotionModel:
    """Return a model of a structure, by default without slip: its parameters are what is the robot's."""
    basis = _core.Basis("none", [], [], []) if slip is None else slip
    if structure == CASCADED:
        model = _core.MotionModel.with_response(basis, hypotheses.clock_offset)
    elif structure == DIRECT:
        model = _core.MotionModel.with_delays(basis)
    elif hypotheses.dynamics:
        model = _core.MotionModel(basis, True, False)
    else:
        model = _core.MotionModel.with_lags(basis, hypotheses.clock_offset)
    wheelbase = hypotheses.wheelbase if hypotheses.dynamics else 0.0
    return model.with_extrinsics(hypotheses.sensor_extrinsics).with_wheelbase(wheelbase)


def _robot(
    known: tuple[_core.SlipOnSurface, int, _core.MotionModel], settings: Settings, best: _core.MotionPosterior
) -> tuple[tuple[str, ...], LearnedNormal | None]:
    """Return what is not slip: of its own average, or of the cascade where that was kept."""
    now, structure, motion = known
    names = tuple(info.name for info in motion.parameters)
    if structure == CASCADED:
        if tuple(info.name for info in best.model.parameters[best.model.basis.size :]) != names:
            return names, None
        estimate = best.estimate
    else:
        estimate = now.state.estimate
    v, omega = now.prior_speeds
    prior = _core.prior_estimate(motion, v, omega, settings.filter_settings().prior)
    first = len(estimate.mean) - len(names)
    return names, LearnedNormal(
        np.array(estimate.mean)[first:],
        np.array(estimate.covariance)[first:, first:],
        np.array(prior.mean),
        np.sqrt(np.diag(np.array(prior.covariance))),
    )

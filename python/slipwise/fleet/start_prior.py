# SPDX-License-Identifier: Apache-2.0
"""What learning of the next robot begins with: mean and covariance over a fleet's robots, by basis."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from slipwise.calibration.log_knowledge import LearnedNormal, LogKnowledge, StructureKnowledge
from slipwise.files import write_text_whole
from slipwise.fleet.empirical_bayes import FleetPrior, fleet_prior
from slipwise.fleet.findings import STUDENT_DOF, ParameterFindings
from slipwise.models.fleet_prior import (
    PRIOR_SCHEMA,
    BasisPrior,
    FleetPriorFile,
    ParameterPrior,
    RobotPrior,
    StartPrior,
)

Floats = NDArray[np.float64]

# Guess of the variance between robots, and between logs of one; of a first log's prior variance.
SPREAD = 0.03
LEFT = 0.05  # of a log's prior, which is taken out of what it says; the rest keeps its covariance finite
FEWEST_STUDENT = 4  # robots, from which on one of them may count less
#: Of fewer, by their number, the variance itself is not known: the square of what their Student t's 90 %
#: interval is over a normal one, with as many degrees of freedom as robots and the guess of them have.
FEW = {2: 2.05, 3: 1.68}
JOINT = "joint"  # the way to explain motion that every log has
KnownLog = tuple[str, LogKnowledge]  # with its vehicle


@dataclass(frozen=True, eq=False)
class _Said:
    """What logs say by themselves, in units of their common prior's standard deviations from its mean."""

    vehicles: list[str]
    estimates: Floats  # [N, P]
    covariances: Floats  # [N, P, P]
    prior_mean: Floats  # [P]
    unit: Floats  # [P]


def start_prior(logs: Sequence[KnownLog]) -> StartPrior | None:
    """Return the prior of a new robot; None where fewer than two robots say something in the same terms.

    Of the inputs, and of the ways to explain motion, the one is taken that most logs have, of those that two
    robots have; logs of the other input say nothing. The variance between robots is one per parameter, since
    robots are few.
    """
    if not logs:
        return None
    input_name = _most([known.input for _, known in logs])
    same = [(vehicle, known) for vehicle, known in logs if known.input == input_name]
    ways = Counter(known.kept for _, known in same).most_common()
    priors = (_prior(input_name, kept, same) for kept in [*(way for way, _ in ways), JOINT])
    return next((prior for prior in priors if prior is not None), None)


def _prior(input_name: str, kept: str, same: Sequence[KnownLog]) -> StartPrior | None:
    """Return the prior in the terms of one way to explain motion; None where too few robots have it."""
    chosen = [(vehicle, known.structures[kept]) for vehicle, known in same if kept in known.structures]
    robot = _robot([(vehicle, known) for vehicle, known in chosen if known.robot is not None])
    bases = {name: _basis(name, chosen) for name in sorted({n for _, known in chosen for n in known.bases})}
    present = {name: prior for name, prior in bases.items() if prior is not None}
    if robot is None or not present:
        return None
    total = sum(prior.weight for prior in present.values()) or 1.0
    return StartPrior(
        input=input_name,
        structure=kept,
        speeds=np.exp(np.mean(np.log([known.speeds for _, known in chosen]), axis=0)).tolist(),
        bases={name: p.model_copy(update={"weight": p.weight / total}) for name, p in present.items()},
        robot=robot,
    )


def new_robot(said_of: Sequence[tuple[str, LearnedNormal]]) -> tuple[Floats, Floats] | None:
    """Return mean and covariance of a robot of the fleet that nothing is known of, in one log.

    Each log's own prior is taken out of what it says (but for a twentieth), so that it counts once. Logs of
    one robot differ by their ground; their spread is part of what the next log may show.

    Args:
        said_of: what each log learned, with its vehicle; None is returned for fewer than two vehicles.
    """
    said = _said(said_of)
    if len(set(said.vehicles)) < 2:
        return None
    size = said.estimates.shape[1]
    if size == 0:
        return np.empty(0), np.empty((0, 0))
    estimates, covariances, between_logs = _by_vehicle(said)
    prior = _population(estimates, covariances)
    information = np.linalg.inv(prior.mean_covariance)
    of_mean = np.linalg.inv(np.eye(size) + information)  # the prior before any log counts once
    mean = of_mean @ information @ prior.mean
    covariance = of_mean + _variance(prior.between, len(estimates)) + np.diag(between_logs)
    unit = np.outer(said.unit, said.unit)
    return said.prior_mean + said.unit * mean, 0.5 * (covariance + covariance.T) * unit


def _said(said_of: Sequence[tuple[str, LearnedNormal]]) -> _Said:
    learned = [each for _, each in said_of]
    unit = np.exp(np.mean([np.log(each.prior_std) for each in learned], axis=0))
    prior_mean = np.mean([each.prior_mean for each in learned], axis=0)
    pairs = [_evidence(each) for each in learned]
    return _Said(
        [vehicle for vehicle, _ in said_of],
        np.array([(mean - prior_mean) / unit for mean, _ in pairs]).reshape(len(pairs), len(unit)),
        np.array([c / np.outer(unit, unit) for _, c in pairs]).reshape(len(pairs), len(unit), len(unit)),
        prior_mean,
        unit,
    )


def _evidence(learned: LearnedNormal) -> tuple[Floats, Floats]:
    """Return what a log says without its prior: an estimate and its covariance, wide where it says little."""
    unit = learned.prior_std
    precision = np.linalg.inv(learned.covariance / np.outer(unit, unit))
    values, vectors = np.linalg.eigh(0.5 * (precision + precision.T))
    own = np.maximum(values - 1.0, 0.0) + LEFT
    towards = vectors.T @ (precision @ ((learned.mean - learned.prior_mean) / unit))
    estimate = learned.prior_mean + unit * (vectors @ (towards / own))
    return estimate, (vectors / own) @ vectors.T * np.outer(unit, unit)


def _by_vehicle(said: _Said) -> tuple[Floats, Floats, Floats]:
    """Return an estimate and a covariance for each vehicle, and the variance between logs of one [P]."""
    vehicles = sorted(set(said.vehicles))
    members = [np.flatnonzero(np.array(said.vehicles, dtype=object) == vehicle) for vehicle in vehicles]
    several = {
        k: _population(said.estimates[at], said.covariances[at])
        for k, at in enumerate(members)
        if len(at) > 1
    }
    freedom = {k: len(members[k]) - 1 for k in several}
    size = said.estimates.shape[1]
    between = np.zeros(size)
    for k, prior in several.items():
        share = freedom[k] / sum(freedom.values())
        between += share * np.diag(_variance(prior.between, len(members[k])))
    estimates, covariances = np.empty((len(vehicles), size)), np.empty((len(vehicles), size, size))
    for k, at in enumerate(members):
        if k in several:
            estimates[k], covariances[k] = several[k].mean, several[k].mean_covariance
        else:
            estimates[k], covariances[k] = said.estimates[at[0]], said.covariances[at[0]] + np.diag(between)
    return estimates, covariances, between


def _variance(between: Floats, count: int) -> Floats:
    """Return the covariance of the next that is drawn, which a Student t's scale matrix is only a part of."""
    return between * FEW.get(count, STUDENT_DOF / (STUDENT_DOF - 2.0))


def _population(estimates: Floats, covariances: Floats) -> FleetPrior:
    dof = STUDENT_DOF if len(estimates) >= FEWEST_STUDENT else None
    return fleet_prior(estimates, covariances, dof=dof, guess=np.full(estimates.shape[1], SPREAD))


def _basis(name: str, chosen: Sequence[tuple[str, StructureKnowledge]]) -> BasisPrior | None:
    having = [(vehicle, known.bases[name]) for vehicle, known in chosen if name in known.bases]
    size = int(_most([str(len(basis.slip.mean)) for _, basis in having]))
    having = [(vehicle, basis) for vehicle, basis in having if len(basis.slip.mean) == size]
    prior = new_robot([(vehicle, basis.slip) for vehicle, basis in having])
    if prior is None:
        return None
    scale = np.exp(np.mean([np.log(np.maximum(basis.noise_scale, 1e-12)) for _, basis in having], axis=0))
    return BasisPrior(
        mean=prior[0].tolist(),
        covariance=prior[1].tolist(),
        weight=float(np.mean([basis.weight for _, basis in having])),
        variance_scale=scale.tolist(),
    )


def _robot(chosen: Sequence[tuple[str, StructureKnowledge]]) -> RobotPrior | None:
    if not chosen:
        return None
    names = Counter(known.robot_names for _, known in chosen).most_common(1)[0][0]
    prior = new_robot(
        [(v, known.robot) for v, known in chosen if known.robot_names == names and known.robot is not None]
    )
    if prior is None:
        return None
    return RobotPrior(parameters=list(names), mean=prior[0].tolist(), covariance=prior[1].tolist())


def _most(names: Sequence[str]) -> str:
    return Counter(names).most_common(1)[0][0]


def write_prior(
    path: Path,
    findings: Sequence[ParameterFindings],
    knowledge: Sequence[KnownLog] = (),
    *,
    vehicle_type: str = "",
) -> Path:
    """Write the prior of a robot of this fleet as a YAML file; return the path.

    Parameters of a single vehicle are left out: one robot says nothing of the next.

    Raises:
        OutputError: the file cannot be written.
    """
    parameters = {
        each.parameter: ParameterPrior(
            unit=each.unit,
            mean=float(each.prior.mean[0]),
            std=math.sqrt(float(each.prior.new_robot[0, 0])),
            between_robots_std=math.sqrt(float(each.prior.between[0, 0])),
            robots=len(each.vehicles),
        )
        for each in findings
        if each.prior is not None
    }
    head = "# The prior of a robot of this fleet before its first log; units as in model files.\n"
    content = FleetPriorFile(
        slipwise_fleet_prior=PRIOR_SCHEMA,
        type=vehicle_type,
        robots=len({vehicle for vehicle, _ in knowledge}),
        logs=len(knowledge),
        parameters=parameters,
        start=start_prior(knowledge),
    ).model_dump()
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120)
    write_text_whole(path, head + text)
    return path

# SPDX-License-Identifier: Apache-2.0
"""Learning that begins with what a fleet knows of a type of robot, and says what it learned for a fleet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.calibrate import JUDGING_HORIZONS, calibrate, calibrate_by
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import Keep, learn_with, new_learner
from slipwise.calibration.learner import STRUCTURES, Progress
from slipwise.calibration.log_knowledge import LogKnowledge, knowledge_of, robot_model
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import WindowSet, choose_input, has_wheels
from slipwise.calibration.result import Calibration
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.calibration.statistics import held_out_half
from slipwise.errors import ModelError, SettingsError
from slipwise.files import sha256_of
from slipwise.logs.log import Log
from slipwise.models import schema
from slipwise.models.fleet_prior import FleetPriorFile, StartPrior, load_prior
from slipwise.models.model import Model

AGAINST = 3.0  # log odds of held-out windows against a prior, from which on it is left away: 20 to 1
BEGUN_SECONDS = 5.0  # s of driving that the fleet's speeds count as; the robot's own soon outweigh them


@dataclass(frozen=True)
class KnownFleet:
    """A fleet's prior, and where it stands."""

    path: Path
    content: FleetPriorFile

    @classmethod
    def load(cls, path: Path) -> KnownFleet:
        """Read a file of `slipwise fleet`.

        Raises:
            ModelError: it is no such file.
        """
        return cls(path, load_prior(path))


def calibrate_from(
    log: Log,
    prior: KnownFleet | None,
    *,
    input: str | None = None,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> tuple[Calibration, LogKnowledge | None]:
    """Learn a log from a fleet's prior, or as ever; also return what it says in the terms of every basis.

    With a prior the log is learned twice. Where held-out windows speak against the prior, the robot is not
    one of that fleet, or drives on other ground: then the prior is left away, and a note says so.

    Args:
        log: what `open_log` returned.
        prior: of the robot's type; None to begin as `calibrate` does.
        input: "command" or "wheel"; by default that of the prior, else commands where the log has them.
        settings: what to learn and how.
        progress: called with the fraction done, 0 to 1.

    Raises:
        LogError: the log has no such input, no poses or no window to learn from, or no model holds it.
        SettingsError: the estimator has no such prior, or a basis or a term is unknown.
        ModelError: the prior is of another input or of other bases, or of too few robots.
    """
    settings = for_the_ground_of(log, settings or Settings())
    if settings.estimator != AVERAGE:
        if prior is not None:
            raise SettingsError(
                f"only the estimator {AVERAGE!r} begins with a prior",
                where="--prior",
                advice="leave one away",
            )
        return calibrate(log, input=input, settings=settings, progress=progress), None
    if prior is None:
        return _learned(log, choose_input(log, input), settings, progress=progress)
    start = start_of(prior)
    input_name = choose_input(log, input or start.input)
    begun = _learned(log, input_name, settings, begin=(start, str(prior.path)), progress=progress)
    fresh = _learned(log, input_name, settings)
    if score_gain(begun[0], fresh[0]) < -AGAINST:
        note = f"{prior.path} was left away: without it, held-out windows of this log are predicted better"
        return replace(fresh[0], notes=(*fresh[0].notes, note)), fresh[1]
    return _told(begun[0], prior), begun[1]


def _learned(
    log: Log,
    input_name: str,
    settings: Settings,
    *,
    begin: tuple[StartPrior, str] | None = None,
    progress: Progress | None = None,
) -> tuple[Calibration, LogKnowledge | None]:
    """Learn a log, from a prior (with its file) where one is given."""
    learner = new_learner(log.runs, input_name, settings, JUDGING_HORIZONS)

    def learn(windows: WindowSet) -> Learned:
        if begin is not None:
            begin_from(learner, begin[0], input_name, wheels=has_wheels(windows.drive), where=begin[1])
        keep = Keep(settings.wheel_separation)
        return learn_with(learner, windows.drive, JUDGING_HORIZONS, keep=keep, progress=progress)

    calibration = calibrate_by(learn, log, input_name, settings)
    return calibration, knowledge_of(learner, input_name, settings)


def score_gain(begun: Calibration, fresh: Calibration) -> float:
    """Return by how much a prior raises the log score of held-out windows of the shortest horizon.

    Over their second half: the first would favour whoever knew something before.
    """
    for first, second in zip(begun.predictions, fresh.predictions, strict=True):
        if len(first) and len(first) == len(second):
            half = held_out_half(len(first))
            return float((_log_scores(first) - _log_scores(second))[half].sum())
    return 0.0


def _log_scores(predictions: Predictions) -> NDArray[np.float64]:
    """Return the normal log density of what was measured, but for its constant, [N]."""
    volume = np.linalg.slogdet(predictions.covariance)[1]
    return np.asarray(-0.5 * (predictions.nis + volume), dtype=np.float64)


def begin_from(
    learner: _core.MotionLearner, start: StartPrior, input_name: str, *, wheels: bool, where: str = ""
) -> None:
    """Let a learner begin with a robot of a fleet, before anything is pushed.

    Slip, lags, delays and offsets begin with the fleet's mean and the covariance of a new robot. Weights of
    bases begin with the fleet's, and follow this robot from the first segment on.

    Args:
        learner: which has learned nothing yet.
        start: of the same input.
        input_name: of the learner, "command" or "wheel".
        wheels: whether wheel speeds will come beside commands.
        where: file of the prior, for errors.

    Raises:
        ModelError: the prior is of another input, or of other bases than are learned.
    """
    if start.input != input_name:
        raise ModelError(
            f"the prior is of {start.input}s, and this is learned from {input_name}s",
            where=where,
            advice=f"say --input {start.input}, or make a prior of {input_name}s",
        )
    structure = STRUCTURES.index(start.structure)
    motion = robot_model(structure, learner.settings.hypotheses)
    ours = {basis.name: basis.size for basis in learner.settings.hypotheses.bases}
    bases = {name: each for name, each in start.bases.items() if ours.get(name) == len(each.mean)}
    names = [info.name for info in motion.parameters]
    if not bases or start.robot.parameters != names:
        raise ModelError(
            "the prior is of other terms or parameters than are learned here",
            where=where,
            advice="make it with the same settings and basis",
        )
    try:
        now = learner.model()
        learner.begin_with(_known(start, structure, motion, now.motion.noise), now.disturbance.law, wheels)
    except ValueError as problem:
        raise ModelError(f"learning cannot begin with the prior: {problem}", where=where) from problem


def _known(
    start: StartPrior, structure: int, motion: _core.MotionModel, noise: _core.MotionNoise
) -> _core.KnownBefore:
    """Return the prior as the core takes it: a robot, and one surface that it is on."""
    v, omega = start.speeds
    robot = np.array(start.robot.mean, dtype=np.float64)
    size = len(robot)
    posterior = _core.MotionPosterior(
        motion,
        _core.Estimate(robot, np.array(start.robot.covariance, dtype=np.float64).reshape(size, size)),
        np.ones(size),
        noise,
        np.ones(3),
    )
    slips = []
    for basis in start.bases.values():
        terms = len(basis.mean)
        slips.append(
            _core.SurfaceSlip(
                np.array(basis.mean, dtype=np.float64),
                np.array(basis.covariance, dtype=np.float64).reshape(terms, terms),
                np.zeros((terms, size)),
                robot,
                (v, omega),
                np.array(basis.variance_scale, dtype=np.float64),
            )
        )
    weights = np.array([basis.weight for basis in start.bases.values()])
    memory = _core.SurfaceMemory(list(start.bases), slips, weights / max(float(weights.sum()), 1e-300), 0)
    surface = _core.KnownSurface("fleet", (BEGUN_SECONDS, v, omega), (1, 1), "", memory, [])
    return _core.KnownBefore(posterior, structure, [surface], (0.0, 0.0))


def start_of(prior: KnownFleet) -> StartPrior:
    """Return what learning begins with.

    Raises:
        ModelError: fewer than two robots could be used.
    """
    if prior.content.start is None:
        raise ModelError(
            "this fleet has no prior for the next robot: fewer than two robots could be used",
            where=str(prior.path),
            advice="run `slipwise fleet` on logs of several robots of the type",
        )
    return prior.content.start


def _told(calibration: Calibration, prior: KnownFleet) -> Calibration:
    """Say in the model and in the notes that learning began with a fleet."""
    content = calibration.model.content
    reference = schema.LogReference(path=str(prior.path), sha256=sha256_of(prior.path))
    provenance = content.provenance.model_copy(update={"prior": reference})
    name = f" of type {prior.content.type}" if prior.content.type else ""
    note = (
        f"learning began with {prior.path}: {prior.content.robots} robots{name}; what this log does not show "
        "is theirs"
    )
    return replace(
        calibration,
        model=Model(content.model_copy(update={"provenance": provenance})),
        notes=(*calibration.notes, note),
    )

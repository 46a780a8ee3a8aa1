# SPDX-License-Identifier: Apache-2.0
"""Which parameters a log determines, found by learning from it as `calibrate` does."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise.calibration import Settings
from slipwise.calibration.calibrate import JUDGING_HORIZONS, learning_windows, refuse_empty
from slipwise.calibration.identifiability import drives_for
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.learner import Posterior
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.verdict import POSITIONS_ONLY
from slipwise.errors import LogError
from slipwise.logs import LeftOut, Log
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import has_course
from slipwise.models.schema import UNIDENTIFIABLE_RATIO


@dataclass(frozen=True)
class LearnableParameter:
    """One parameter as far as the log tells."""

    name: str
    unit: str
    value: float
    std: float
    variance_ratio: float  # posterior / prior variance: 0 all is known, 1 the log says nothing

    @property
    def identifiable(self) -> bool:
        """Whether the log tells more than was assumed before."""
        return self.variance_ratio <= UNIDENTIFIABLE_RATIO


@dataclass(frozen=True)
class Learnability:
    """What could be learned from one kind of input."""

    input: str  # "command" or "wheel"
    windows: int
    seconds: float  # s of driving in these windows
    parameters: tuple[LearnableParameter, ...]
    left_out: tuple[LeftOut, ...]  # while windows were cut
    missing: str  # why nothing could be learned; empty where something could
    advice: tuple[str, ...]  # the drives that would determine the rest
    contradictions: tuple[Finding, ...] = ()  # between the poses and these inputs

    def parameter(self, name: str) -> LearnableParameter | None:
        """Return a parameter, None where the model has no such."""
        return next((p for p in self.parameters if p.name == name), None)


def learnability_of(
    log: Log, input_name: str, settings: Settings, kept: dict[str, Learned] | None = None
) -> Learnability:
    """Learn as `calibrate` does and say what is determined; nothing to learn is no error.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel".
        settings: of the learner.
        kept: gets what was learned, by input, with the predictions and limits that a model needs.
    """
    found = findings_of(
        log, input_name, settings.segment.unknown_after, sensor=settings.sensor_extrinsics.pose
    )
    return replace(_learned(log, input_name, settings, kept), contradictions=found)


def _learned(log: Log, input_name: str, settings: Settings, kept: dict[str, Learned] | None) -> Learnability:
    try:
        windows = learning_windows(prepare_run(log, input_name), input_name, settings)
        refuse_empty(windows, log)
    except LogError as nothing:
        reason = f"{nothing.what}{f': {nothing.advice}' if nothing.advice else ''}"
        return Learnability(input_name, 0, 0.0, (), (), reason, ())
    if kept is None:
        posterior = learn_log(windows.drive, settings, ()).identifiable
    else:
        keep = Keep(settings.wheel_separation)
        kept[input_name] = learn_log(windows.drive, settings, JUDGING_HORIZONS, keep=keep)
        posterior = kept[input_name].identifiable
    parameters = tuple(
        _parameter((info.name, info.unit), posterior, i) for i, info in enumerate(posterior.motion.parameters)
    )
    positions = has_course(log.runs)
    unknown = tuple(parameter.name for parameter in parameters if not parameter.identifiable)
    return Learnability(
        input=input_name,
        windows=len(windows),
        seconds=float(np.sum(windows.end - windows.start)),
        parameters=parameters,
        left_out=windows.left_out,
        missing="",
        advice=(*((POSITIONS_ONLY,) if positions else ()), *drives_for(unknown, positions=positions)),
    )


def _parameter(named: tuple[str, str], posterior: Posterior, i: int) -> LearnableParameter:
    return LearnableParameter(
        *named,
        float(posterior.mean[i]),
        float(np.sqrt(posterior.covariance[i, i])),
        float(posterior.variance_ratio[i]),
    )

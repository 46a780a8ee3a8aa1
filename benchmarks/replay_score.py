# SPDX-License-Identifier: Apache-2.0
"""One log pushed through the streaming learner with any settings: held-out errors, coverage, time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from data_sets import DataSet
from log_score import FEWEST_WINDOWS, geometric_mean

from slipwise import _core
from slipwise.calibration.learned_log import held_out_predictions
from slipwise.calibration.statistics import coverage, held_out_half, normal_coverage
from slipwise.logs import Log
from slipwise.segments import recording_of

WHEEL_SEPARATION = 0.6  # m, from which the search for limits starts


@dataclass(frozen=True)
class ReplayScore:
    """One log with one input, at one horizon; mean errors over the baseline's, of the second half."""

    log: str
    input: str
    windows: int  # held out
    position: float
    heading: float
    inside: tuple[float, float, float]  # fractions within the 50, 90 and 95 % ellipsoids of the predicted t
    inside_normal: tuple[float, float, float]  # the same without Student-t calibration
    seconds: float  # of processor time, to learn
    limits_seconds: float = 0.0  # to look for the actuator's limits afterwards, where that was asked
    limits_kept: bool = False  # limits were found, and predict better


@dataclass(frozen=True)
class MeanReplay:
    """Some logs together: geometric means of errors, fractions inside over all windows, sums of times."""

    logs: int
    position: float
    heading: float
    inside: tuple[float, float, float]
    inside_normal: tuple[float, float, float]
    seconds: float
    limits_seconds: float
    limits_kept: int

    def as_dict(self) -> dict[str, Any]:
        """Return the fields, for JSON."""
        return asdict(self)


def replay_score(data: DataSet, log: Log, core: _core.LearnerSettings, *, limits: bool) -> ReplayScore | None:
    """Push a log; None where too few windows are held out.

    Args:
        data: the log's name and horizon, which must be the first of the settings.
        log: its content.
        core: settings of the learner.
        limits: look for limits of the actuator too, as `calibrate` does.
    """
    begin = time.process_time()
    learner = _core.MotionLearner(core)
    for run in log.runs:
        learner.start_run()
        learner.push(recording_of(run))
        learner.events()
    learner.end_run()
    seconds = time.process_time() - begin
    model = learner.model()
    (learned,), (baseline,) = held_out_predictions(model, (data.horizon,))
    half = held_out_half(len(learned))
    if len(learned.pose[half]) < FEWEST_WINDOWS:
        return None
    begin = time.process_time()
    found = learner.find_limits(WHEEL_SEPARATION) if limits else None
    return ReplayScore(
        log=data.name,
        input="command" if core.stream.from_commands else "wheel",
        windows=len(learned.pose[half]),
        position=float(learned.position_error[half].sum() / baseline.position_error[half].sum()),
        heading=float(learned.heading_error[half].sum() / baseline.heading_error[half].sum()),
        inside=coverage(learned.inside[half]),
        inside_normal=normal_coverage(learned.reported_nis[half]),
        seconds=seconds,
        limits_seconds=time.process_time() - begin,
        limits_kept=found is not None and found.posterior is not None,
    )


def mean_replay(scores: Sequence[ReplayScore]) -> MeanReplay | None:
    """Average logs; None where there are none."""
    if not scores:
        return None
    return MeanReplay(
        logs=len(scores),
        position=geometric_mean([s.position for s in scores]),
        heading=geometric_mean([s.heading for s in scores]),
        inside=_pooled(scores, "inside"),
        inside_normal=_pooled(scores, "inside_normal"),
        seconds=sum(s.seconds for s in scores),
        limits_seconds=sum(s.limits_seconds for s in scores),
        limits_kept=sum(s.limits_kept for s in scores),
    )


def _pooled(scores: Sequence[ReplayScore], name: str) -> tuple[float, float, float]:
    windows = [s.windows for s in scores]
    half, nine_tenths, most = np.average([getattr(s, name) for s in scores], axis=0, weights=windows).tolist()
    return half, nine_tenths, most

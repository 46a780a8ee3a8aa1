# SPDX-License-Identifier: Apache-2.0
"""Scores any method's prediction file on a log, by the rules of `evaluate`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from slipwise.calibration.prepared_run import choose_input
from slipwise.calibration.settings import Settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import LogError
from slipwise.evaluation.evaluate import EvaluationOptions, contest_of
from slipwise.evaluation.methods import method_info
from slipwise.evaluation.read_predictions import predictions_on, read_predictions
from slipwise.evaluation.result import Evaluation, Score
from slipwise.evaluation.scoring import scores_of
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.log import Log

_UNKNOWN = float("nan")


def score_predictions(
    path: Path, log: Log, *, input: str | None = None, settings: Settings | None = None
) -> Evaluation:
    """Score the second half of the windows, each method beside the baseline, which is computed here.

    Where the file has no covariances, NIS and coverage are NaN. A method is called causal where no row has
    learned later than its start; a file without `learned_until` is believed.

    Args:
        path: the prediction file.
        log: the log that it is of.
        input: "command" or "wheel": whose baseline and windows; commands where the log has them.
        settings: rules of windows, and where the pose sensor is.

    Raises:
        LogError: the file or the log is wrong, or the file does not fit the log.
    """
    settings = for_the_ground_of(log, settings or Settings())
    rows = read_predictions(path)
    input_name = choose_input(log, input)
    contest, notes = contest_of(log, input_name, settings, EvaluationOptions(rows.horizons))
    if len(contest.targets) < len(rows.horizons):
        raise LogError("; ".join(notes), where=str(path), advice="leave these rows out")
    runs = tuple(run.name for run in log.runs)
    predictions = [p for targets in contest.targets for p in predictions_on(rows, targets, runs)]
    baseline = {each.horizon: each for each in method_info("none").predict("none", contest)}
    scores = scores_of(predictions, baseline, contest.targets)
    if not rows.has_covariance:
        scores = tuple(_without_covariance(score) for score in scores)
    return Evaluation(
        input=input_name,
        horizons=tuple(targets.length for targets in contest.targets),
        methods=rows.methods,
        scores=scores,
        predictions=tuple(predictions),
        runs=runs,
        left_out=log.left_out + contest.targets[-1].left_out,
        notes=log.notes + notes,
        contradictions=findings_of(
            log, input_name, settings.segment.unknown_after, sensor=settings.sensor_extrinsics.pose
        ),
    )


def _without_covariance(score: Score) -> Score:
    unknown = (_UNKNOWN, _UNKNOWN, _UNKNOWN)
    return replace(score, nis=_UNKNOWN, coverage=unknown, reported_nis=_UNKNOWN, reported_coverage=unknown)

# SPDX-License-Identifier: Apache-2.0
"""The report of a calibration: what was learned, beside the baseline and two fitted numbers."""

from __future__ import annotations

from pathlib import Path

from slipwise.calibration.result import Calibration
from slipwise.calibration.settings import Settings
from slipwise.evaluation import EvaluationOptions, evaluate, proposing
from slipwise.logs.log import Log
from slipwise.reporting.report import write_report

BASELINES = ("none", "edd-2")


def report_calibration(  # noqa: PLR0913 - what was learned from what, and how to call it
    path: Path,
    log: Log,
    calibration: Calibration,
    settings: Settings,
    *,
    command: str = "",
    model: Path = Path("model.yaml"),
) -> Calibration:
    """Judge what was learned on its log beside the baselines, and write the page.

    Returns the calibration, whose advice names a simpler method where one is clearly better.

    Args:
        path: the HTML file to write.
        log: what was learned from.
        calibration: what was learned.
        settings: what it was learned with.
        command: the command line, shown as provenance.
        model: where the model is written.

    Raises:
        OutputError: the file cannot be written.
    """
    learned = [calibration.method]
    if calibration.history is None:
        learned.append(settings.estimator)
    evaluation = evaluate(
        log,
        input=calibration.model.content.input,
        settings=settings,
        options=EvaluationOptions(
            methods=tuple(dict.fromkeys((*BASELINES, *learned))),
            made={calibration.method: calibration.predictions, "none": calibration.baseline},
        ),
    )
    calibration = proposing(calibration, evaluation)
    title = ", ".join(run.name for run in log.runs[:3])
    write_report(
        path,
        log=log,
        calibration=calibration,
        evaluation=evaluation,
        title=title,
        command=command,
        model=model,
    )
    return calibration

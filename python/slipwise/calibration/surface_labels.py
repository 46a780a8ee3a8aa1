# SPDX-License-Identifier: Apache-2.0
"""What a log says of the surface under the robot: labels with their times, and the date."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from slipwise.calibration.prepared_run import PreparedRun
from slipwise.errors import SettingsError
from slipwise.logs.log import Run
from slipwise.models.schema import LONGEST_NAME

COLUMN = "terrain"  # of a tidy log
_EPOCH = 1e8  # s; stamps beyond this count from 1970, smaller ones from some start of their own


def labels_of(run: Run) -> tuple[tuple[float, str], ...]:
    """Return when the column `terrain` names another surface, and its name; empty cells say nothing."""
    column = run.extra.get(COLUMN)
    if column is None:
        return ()
    stamps = np.asarray(run.extra["t"], dtype=np.float64)
    cues: list[tuple[float, str]] = []
    for t, value in zip(stamps, column, strict=True):
        name = "" if value is None or value != value else str(value).strip()[:LONGEST_NAME]
        if name and np.isfinite(t) and (not cues or cues[-1][1] != name):
            cues.append((float(t), name))
    return tuple(cues)


def label_at_start(cues: Sequence[tuple[float, str]], run: Run) -> str:
    """Return the label that a run begins with; an empty string if the first one comes later."""
    return cues[0][1] if cues and cues[0][0] <= run.span[0] else ""


def date_of(drive: Sequence[PreparedRun]) -> str:
    """Return the day (UTC) on which the drive began; an empty string if stamps do not count from 1970."""
    start = drive[0].run.span[0]
    return datetime.fromtimestamp(start, UTC).date().isoformat() if start > _EPOCH else ""


def given_labels(labels: Sequence[str], logs: int) -> tuple[str, ...]:
    """Return one label per log; one that was given stands for all.

    Raises:
        SettingsError: there are neither one nor as many as logs, or one is empty or too long.
    """
    if any(not label.strip() or len(label) > LONGEST_NAME for label in labels):
        raise SettingsError(
            "a label is a name of 1 to 80 characters", where="--surface", advice="such as --surface sand"
        )
    if len(labels) not in (0, 1, logs):
        raise SettingsError(
            f"{len(labels)} labels for {logs} logs",
            where="--surface",
            advice="give one for all, or one for each log",
        )
    return tuple(labels) * logs if len(labels) == 1 else tuple(labels)

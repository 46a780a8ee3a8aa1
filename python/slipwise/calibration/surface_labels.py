# SPDX-License-Identifier: Apache-2.0
"""What a log says of the surface under the robot: labels with their times, and the date."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from datetime import UTC, datetime

import numpy as np

from slipwise.calibration.prepared_run import PreparedRun
from slipwise.errors import SettingsError
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import Run
from slipwise.models.schema import LONGEST_NAME

COLUMN = "terrain"  # of a tidy log
_LONG = 20.0  # s of a name, from which on it is to be remembered
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


def named_seconds(drive: Sequence[PreparedRun], label: str = "") -> dict[str, float]:
    """Return how long the log of a drive names each surface [s]; a label of all of it replaces its column."""
    found: dict[str, float] = {}
    for run in (each.run for each in drive):
        start, end = run.span
        cues = ((start, label),) if label else labels_of(run)
        ends = (*(t for t, _ in cues[1:]), end)
        for (t, name), until in zip(cues, ends, strict=False):
            found[name] = found.get(name, 0.0) + max(min(until, end) - max(t, start), 0.0)
    return found


def overruled(named: Mapping[str, float], remembered: Collection[str]) -> tuple[Finding, ...]:
    """Return that surfaces which logs name are none of those that are remembered by now, where any is."""
    gone = {name: seconds for name, seconds in named.items() if seconds > _LONG and name not in remembered}
    if not gone:
        return ()
    names = " and ".join(f"{name} for {seconds:.0f} s" for name, seconds in gone.items())
    what = (
        f"labels name {names}, and no surface that is remembered is called so: they are blended with others"
    )
    advice = (
        "Where the labels are right, give longer stretches of each surface, or calibrate one model for each: "
        "--start and --end, or a log for each."
    )
    return (Finding("labels-overruled", what, (advice,), spoils=False, reserves=True),)


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

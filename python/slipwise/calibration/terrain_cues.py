# SPDX-License-Identifier: Apache-2.0
"""Joins what sensors said of the surface with the runs of logs, by run and time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from slipwise.calibration.learned_log import Cue
from slipwise.calibration.prepared_run import PreparedRun
from slipwise.errors import LogError
from slipwise.terrain.label_file import Window

Labels = Mapping[str, Sequence[Window]]


def cues_of(labels: Labels, run: PreparedRun) -> tuple[Cue, ...]:
    """Return what was said while a run was driven, each when it was known: at its window's end."""
    first, last = run.run.span
    windows = labels.get(run.run.name, ())
    return tuple((each.end, each.answer) for each in windows if first <= each.end <= last)


def check_labels(labels: Labels, drives: Sequence[Sequence[PreparedRun]]) -> None:
    """Refuse labels that go with no run, or with several.

    Raises:
        LogError: no run has labels, the labels of one lie at other times than it was driven, or two logs
            have a run of one name at the same times.
    """
    runs = [run.run for drive in drives for run in drive]
    named = [run for run in runs if run.name in labels]
    if not named:
        raise LogError(
            f"the labels are of runs {_some(sorted(labels))}, the logs have {_some([r.name for r in runs])}",
            where="--surface",
            advice="name the runs alike in both, in the column `run`",
        )
    for place, run in enumerate(named):
        windows, (first, last) = labels[run.name], run.span
        if not any(first <= window.end <= last for window in windows):
            raise LogError(
                f"run {run.name} was driven from {first:.1f} to {last:.1f} s and its labels are from "
                f"{windows[0].start:.1f} to {windows[-1].end:.1f} s",
                where="--surface",
                advice="stamp both by one clock",
            )
        for other in named[:place]:
            if other.name == run.name and other.span[0] <= last and first <= other.span[1]:
                raise LogError(
                    f"two logs have a run {run.name} at the same times, and labels of one",
                    where="--surface",
                    advice="name the runs differently in the column `run`",
                )


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:3])
    return f"{shown} and {len(names) - 3} more" if len(names) > 3 else shown

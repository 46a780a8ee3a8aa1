# SPDX-License-Identifier: Apache-2.0
"""Logs that are learned together though their robots answer otherwise: the model is of the last one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from slipwise.calibration.rate_fits import Floats
from slipwise.calibration.shares import RUN, Answer, PoseSensor, answers_of
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import Run
from slipwise.models.schema import Share
from slipwise.number_text import estimate_text

KIND = "unlike-logs"
_APART = 0.15  # of what the others do; what arrives differs by less from drive to drive
_CLEAR = 5.0  # standard deviations
_NO_FLOOR = {"drives": 2.0, "turns": 3.0}  # times as much or as little: no other floor does that
_LITTLE, _WELL = 0.3, 0.7  # of the squares of what poses do, that inputs explain
_AS_MUCH = 0.3  # as the inputs of others vary
_FROM = {"command": "its commands", "wheel": "its wheels' speeds"}


def unlike_logs(
    rows: Floats, runs: Sequence[Run], input_name: str, sensor: PoseSensor
) -> tuple[Finding, ...]:
    """Return that what arrives of the inputs differs from file to file, where several are learned together.

    Args:
        rows: windows of all runs, as `_core.MotionEvidence` has them.
        runs: by the windows' number of the run.
        input_name: "command" or "wheel".
        sensor: what is known of the pose sensor.
    """
    files = [run.files[0] if run.files else run.name for run in runs]
    if len(set(files)) == 1:
        return ()
    names = dict.fromkeys(files)
    of_file = np.array([list(names).index(file) for file in files])[rows[:, RUN].astype(np.int64)]
    answers = {
        Path(file).name: answers_of(rows[of_file == k], input_name, sensor) for k, file in enumerate(names)
    }
    for verb, axis in (("drives", "speed"), ("turns", "yaw_rate")):
        known = {file: each[axis] for file, each in answers.items() if axis in each}
        found = _unrelated(known, verb, _FROM[input_name]) or _apart(known, verb, _FROM[input_name])
        if found is not None:
            return (found,)
    return ()


def _unrelated(answers: Mapping[str, Answer], verb: str, inputs: str) -> Finding | None:
    """Look for a file whose inputs explain little of what its poses do, as they do in others."""
    for file, answer in answers.items():
        usual = _usual(answers, file, lambda each: each.explained)
        as_much = answer.varied > _AS_MUCH * usual.varied
        if as_much and answer.explained < _LITTLE and usual.explained > _WELL:
            return _found(
                f"the log {file} {verb} otherwise than {inputs} say, which explain "
                f"{_part(answer)} % of it, in others {_part(usual)} %",
                answer.explained,
                spoils=True,
            )
    return None


def _apart(answers: Mapping[str, Answer], verb: str, inputs: str) -> Finding | None:
    """Look for the file in which another part of the inputs arrives."""
    worst, most = None, 0.0
    for file, answer in answers.items():
        share, usual = answer.share, _usual(answers, file, lambda each: each.share.value).share
        off = abs(share.value - usual.value)
        clear = off > _CLEAR * float(np.hypot(share.std, usual.std))
        if clear and off > max(_APART * abs(usual.value), most):
            worst, most = (file, share, usual), off
    if worst is None:
        return None
    file, share, usual = worst
    times = share.value / usual.value if usual.value != 0.0 else math.inf
    return _found(
        f"the log {file} {verb} {_percent(share)} % of {inputs}, others {_percent(usual)} %",
        times,
        spoils=not 1.0 / _NO_FLOOR[verb] < times < _NO_FLOOR[verb],
    )


def _usual(answers: Mapping[str, Answer], file: str, number: Callable[[Answer], float]) -> Answer:
    """Return the one of the other files by which half of them are nearer; its own where it is alone."""
    own = number(answers[file])
    others = [each for other, each in answers.items() if other != file]
    others.sort(key=lambda each: abs(number(each) - own))
    return others[(len(others) - 1) // 2] if others else answers[file]


def _found(what: str, evidence: float, *, spoils: bool) -> Finding:
    return Finding(
        KIND,
        f"{what}: this is not one robot on one floor, and a model of all follows the last of them",
        ("Learn it apart, other floors, loads or tyres with --memory; or mend its units.",),
        spoils=spoils,
        reserves=not spoils,
        evidence=evidence,
    )


def _percent(share: Share) -> str:
    return estimate_text(100.0 * share.value, 100.0 * share.std)


def _part(answer: Answer) -> str:
    return f"{100.0 * max(answer.explained, 0.0):.0f}"

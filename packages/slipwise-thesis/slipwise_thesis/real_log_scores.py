# SPDX-License-Identifier: Apache-2.0
"""Every surface and estimator on real logs, judged by what it predicts before it has learned it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from slipwise.errors import LogError
from slipwise.evaluation import EvaluationOptions, Score, evaluate
from slipwise.logs import Log
from slipwise_thesis.fixture import ENDINGS, Fixture, MissingLogError

HUSKY = "husky/tile_deflated_tyres"
WARTHOG_FOLDERS = ("warthog", "warthog_windows")
WARTHOG_LOGS = ("drive_test/warthog",)
INPUTS = ("wheel", "command")
HORIZONS = (1.9, 5.0)  # s; the longest that a log has windows for is shown
SURFACES = ("surface-least-squares", "surface-gaussian-process", "surface-bayesian")
ON_LINE = ("gradient-descent", "ekf-thesis", "iekf", "delayed-state")
METHODS = ("none", "edd-2", "icr-3", "slip-ratio-ekf", *SURFACES, *ON_LINE, "auto", "batch")
FEWEST_WINDOWS = 3  # held out; logs with fewer are listed, not averaged


@dataclass(frozen=True, eq=False)
class LogScores:
    """All methods on one log with one input, at one horizon."""

    log: str
    input: str
    horizon: float  # s
    scores: dict[str, Score]

    @property
    def windows(self) -> int:
        """How many windows are held out: the second half."""
        return self.scores["none"].windows


@dataclass(frozen=True)
class MeanRatios:
    """Geometric means over logs of a method's mean errors, as ratios to those of `none`."""

    logs: int
    position: float
    heading: float
    worst_position: float


def warthog_names(fixture: Fixture) -> list[str]:
    """Return the names of all Warthog logs of the data folder.

    Raises:
        MissingLogError: there is none.
    """
    names = []
    if fixture.data is not None:
        for folder in WARTHOG_FOLDERS:
            for path in sorted((fixture.data / folder).glob("*")):
                ending = next((end for end in ENDINGS if end and path.name.endswith(end)), None)
                if ending is not None:
                    names.append(f"{folder}/{path.name.removesuffix(ending)}")
        names += [name for name in WARTHOG_LOGS if any(_at(fixture, name))]
    if not names:
        raise MissingLogError(
            "the Warthog's logs are missing",
            advice=f"set SLIPWISE_DATA or --data to a folder with {' and '.join(WARTHOG_FOLDERS)} in it",
        )
    return names


def _at(fixture: Fixture, name: str) -> Iterable[bool]:
    return ((fixture.data / f"{name}{ending}").exists() for ending in ENDINGS if fixture.data is not None)


def log_scores(
    fixture: Fixture, names: Sequence[str], progress: Callable[[str, float], None]
) -> list[LogScores]:
    """Score all methods on logs, from wheel speeds and from commands where a log has them.

    Raises:
        MissingLogError: a log is not there.
    """
    found = []
    for done, name in enumerate(names):
        log = fixture.real_log(name)
        for place, input_name in enumerate(INPUTS):
            progress(f"{name}, {input_name}", (done + place / len(INPUTS)) / len(names))
            try:
                found.append(_scores(log, name, input_name))
            except LogError:  # no such input, or too few windows of it
                continue
    return found


def _scores(log: Log, name: str, input_name: str) -> LogScores:
    methods = tuple(m for m in METHODS if input_name == "wheel" or m != "slip-ratio-ekf")
    options = EvaluationOptions(horizons=HORIZONS, methods=methods)
    result = evaluate(log, input=input_name, options=options)
    horizon = result.horizons[-1]
    return LogScores(name, input_name, horizon, {s.method: s for s in result.scores if s.horizon == horizon})


def mean_ratios(found: Sequence[LogScores], method: str) -> MeanRatios | None:
    """Average a method over the logs that have it and enough windows; None where there are none."""
    scores = [log.scores[method] for log in found if method in log.scores and log.windows >= FEWEST_WINDOWS]
    if not scores:
        return None
    position = np.array([score.position_ratio[0] for score in scores])
    heading = np.array([score.heading_ratio[0] for score in scores])
    return MeanRatios(
        len(scores),
        float(np.exp(np.mean(np.log(position)))),
        float(np.exp(np.mean(np.log(heading)))),
        float(position.max()),
    )

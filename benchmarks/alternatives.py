# SPDX-License-Identifier: Apache-2.0
"""A mechanism of learning beside the strongest simple alternative that a user would take in its place."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from data_sets import DataSet, data_sets, required_folder
from log_score import geometric_mean
from numpy.typing import NDArray

import slipwise
from slipwise.calibration import Settings
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.calibration.statistics import held_out_half
from slipwise.logs import Log, LogOptions, Poses
from slipwise.logs.open_log import cut_to_span

HERE = Path(__file__).resolve().parent
sys.path += [str(HERE / "promises"), str(HERE.parent / "python" / "tests")]  # their simulations

Floats = NDArray[np.float64]
Errors = tuple[float, float]  # of position, of heading

CONTINUOUS = ("warthog/grass_7_18_16h59s20", "warthog/grass_8_8_15h56s39", "warthog/asphalt_9_25_12h8s57")
SEED = 3  # of simulations


@dataclass(frozen=True)
class Beside:
    """A mechanism beside its alternative, on real logs or in a simulation."""

    mechanism: str
    alternative: str
    where: str
    ratios: tuple[Errors, ...]  # one a log: errors with the mechanism over the alternative's

    @property
    def mean(self) -> Errors:
        """Geometric means over the logs."""
        position, heading = zip(*self.ratios, strict=True)
        return geometric_mean(position), geometric_mean(heading)


def ratio(with_it: Errors, without: Errors) -> Errors:
    """Return the errors of one over those of the other."""
    return with_it[0] / without[0], with_it[1] / without[1]


def opened(name: str, **options: Any) -> tuple[DataSet, Log]:
    """Open a real log by name."""
    (data,) = [each for each in data_sets(required_folder()) if each.name == name]
    return data, slipwise.open_log(data.path, options=LogOptions(**options))


def held_out(log: Log, settings: Settings, input_name: str, horizon: float = 5.0) -> Errors:
    """Return mean errors of the second half of what a learner predicted before it learned it."""
    chosen = for_the_ground_of(log, settings)
    (made,) = learn_log(prepare_run(log, input_name), chosen, (horizon,)).predictions
    half = held_out_half(len(made))
    return float(made.position_error[half].mean()), float(made.heading_error[half].mean())


def halves(log: Log) -> tuple[Log, Log]:
    """Cut a log in the middle of its time."""
    spans = [run.span for run in log.runs]
    middle = 0.5 * (max(end for _, end in spans) - min(start for start, _ in spans))
    return cut_to_span(log, None, middle), cut_to_span(log, middle, None)


def with_poses(log: Log, change: Callable[[Poses], Poses]) -> Log:
    """Return the log with the poses of every run changed."""
    return replace(log, runs=tuple(replace(run, poses=change(run.poses)) for run in log.runs))


def level(poses: Poses) -> Poses:
    """Return poses without roll and pitch."""
    return replace(poses, roll=None, pitch=None)

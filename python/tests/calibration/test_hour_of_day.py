# SPDX-License-Identifier: Apache-2.0
"""What is learned does not depend on the hour, on the frame of the poses, or on orders of arrival."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from moved_logs import ARRIVALS, MOST, MOVES, differences, moved_log, moved_table, push_arriving
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.sloping_ground import for_the_ground_of
from slipwise.errors import LogError
from slipwise.logs import Log, open_log

INPUTS = ("wheel", "command")
#: Stamps fall on a grid, so that lengths of windows, gaps and holds are met to the last bit.
ON_A_GRID = Drive(seconds=60.0, lag=0.2, delay=0.1, basis=_core.named_basis("edd-2"), alpha=(-0.05, -0.3))


@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("move", MOVES)
def test_the_hour_and_the_frame_change_nothing(name: str, move: str) -> None:
    log = simulated_log(ON_A_GRID)
    found = differences(calibrate(log, input=name), calibrate(moved_log(log, MOVES[move]), input=name))
    assert list(found) == []


@pytest.mark.parametrize("name", INPUTS)
def test_orders_of_arrival_change_nothing(name: str) -> None:
    assert arrivals_that_differ(simulated_log(ON_A_GRID), name) == []


def arrivals_that_differ(log: Log, name: str) -> list[str]:
    """Say in which orders of arrival other parameters are learned."""
    settings = core_settings(for_the_ground_of(log, Settings()), name, (1.0, 2.0, 5.0))
    runs = [each.run for each in prepare_run(log, name)]

    def learned(late: dict[str, float]) -> _core.LearnedModel:
        learner = _core.MotionLearner(settings)
        for run in runs:
            learner.start_run()
            push_arriving(learner, run, late)
        return learner.model()

    expected = learned({}).motion
    std = np.sqrt(np.diag(expected.estimate.covariance))
    found = []
    for order, late in ARRIVALS.items():
        motion = learned(dict(late)).motion
        if motion.structure != expected.structure:
            found.append(f"{order}: another structure")
        elif (moved := np.abs(motion.estimate.mean - expected.estimate.mean) / std).max() > MOST:
            found.append(f"{order}: {moved.max():.2g} sigma")
    return found


@pytest.mark.slow
def test_on_all_real_logs_the_hour_the_frame_and_the_order_change_nothing(
    real_log_dir: Path, tmp_path: Path
) -> None:
    vehicles = real_log_dir.parent / "vehicles"
    paths = (*sorted(real_log_dir.rglob("*.csv.gz")), *sorted(vehicles.glob("*.csv.gz")))
    failures = [
        f"{path.parent.name}/{path.name}, {name}, {each}"
        for path in paths
        for name in INPUTS
        for each in changes(path, name, tmp_path / "moved.csv")
    ]
    assert failures == []


def changes(path: Path, name: str, moved: Path) -> list[str]:
    """Say what changes of what is learned of a table, if anything."""
    try:
        log = open_log(path)
        expected = calibrate(log, input=name)
    except LogError:
        return []  # it has no such input, or cannot be read: others test that
    found = []
    for move, by in MOVES.items():
        other = calibrate(open_log(moved_table(path, moved, by)), input=name)
        found += [f"{move}: {each}" for each in differences(expected, other)]
    plain = all(not run.others and (run.commands is None or run.commands.car is None) for run in log.runs)
    return found + (arrivals_that_differ(log, name) if plain else [])

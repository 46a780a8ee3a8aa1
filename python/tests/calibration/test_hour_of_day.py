# SPDX-License-Identifier: Apache-2.0
"""What is learned does not depend on the hour, on where the frame of the poses lies, or on orders of arrival."""

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
    failures = []
    vehicles = real_log_dir.parent / "vehicles"
    for path in (*sorted(real_log_dir.rglob("*.csv.gz")), *sorted(vehicles.glob("*.csv.gz"))):
        for name in INPUTS:
            place = f"{path.parent.name}/{path.name}, {name}"
            try:
                log = open_log(path)
                expected = calibrate(log, input=name)
            except LogError:
                continue  # it has no such input, or cannot be read: others test that
            for move, by in MOVES.items():
                other = open_log(moved_table(path, tmp_path / "moved.csv", by))
                failures += [f"{place}, {move}: {each}" for each in differences(expected, calibrate(other, input=name))]
            if not any(run.others for run in log.runs) and all(
                run.commands is None or run.commands.car is None for run in log.runs
            ):
                failures += [f"{place}, {each}" for each in arrivals_that_differ(log, name)]
    assert failures == []

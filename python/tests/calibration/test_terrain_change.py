# SPDX-License-Identifier: Apache-2.0
"""A change of terrain is found while learning, said, and learned; without one nothing is forgotten."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.calibration import calibrate, make_settings
from slipwise.logs import Log
from slipwise_sim import Scenario, TerrainChange, TyreLaw, simulate

pytest.importorskip("mujoco")

CHANGE = 82.0  # s
OTHER_GROUND = TyreLaw(slip_stiffness=7.0, cornering_stiffness=8.5)  # yaw slip -0.55 where it was -0.37


@pytest.fixture(scope="module")
def changing() -> Log:
    scenario = Scenario(duration=CHANGE + 25.0, change=TerrainChange(CHANGE, OTHER_GROUND))
    return simulate(scenario, seed=1).log


def until(log: Log, t: float) -> Log:
    run = log.runs[0]
    poses, keep = run.poses, run.poses.t < t
    fields = {
        name: value[keep]
        for name, value in vars(poses).items()
        if isinstance(value, np.ndarray) and len(value) == len(keep)
    }
    return replace(log, runs=(replace(run, poses=replace(poses, **fields)),))


def test_step_of_yaw_slip_is_found_within_three_windows(changing: Log) -> None:
    history = calibrate(changing, input="wheel").history
    assert history is not None
    (alarm,) = history.alarms()
    assert alarm[0] == 0
    assert CHANGE < alarm[1] <= CHANGE + 3.2


def test_step_is_found_from_commands(changing: Log) -> None:
    history = calibrate(changing, input="command").history
    assert history is not None
    (alarm,) = history.alarms()
    assert CHANGE < alarm[1] <= CHANGE + 5.0


def test_step_is_told_sooner_where_wheels_are_beside_the_commands(changing: Log) -> None:
    bare = replace(changing, runs=tuple(replace(run, wheels=None) for run in changing.runs))
    found = {}
    for name, log in (("with wheels", changing), ("alone", bare)):
        history = calibrate(log, input="command").history
        assert history is not None
        ((_, found[name]),) = history.alarms()
    assert CHANGE < found["with wheels"] <= CHANGE + 5.0
    assert found["with wheels"] < found["alone"] <= CHANGE + 10.0


def test_step_is_learned_sooner_by_branches(changing: Log) -> None:
    learned = {}
    for branches in (True, False):
        settings = make_settings({"basis": "edd-2", "change": {"branches": branches}})
        history = calibrate(changing, input="wheel", settings=settings).history
        assert history is not None
        learned[branches] = history.mean[history.t <= CHANGE + 12.0, history.names.index("ang.w")][-1]
    assert learned[True] < learned[False] - 0.05


def test_drive_over_one_ground_raises_no_alarm(changing: Log) -> None:
    history = calibrate(until(changing, CHANGE), input="wheel").history
    assert history is not None
    assert history.alarms() == ()
    assert (history.change >= 0.0).all()

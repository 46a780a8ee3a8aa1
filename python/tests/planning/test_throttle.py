# SPDX-License-Identifier: Apache-2.0
"""Rollouts and the controller drive a car by throttle and steering, as `predict` says that it goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_cars import write_car_log

import slipwise as sw
from slipwise.errors import SettingsError
from slipwise.logs import LogOptions
from slipwise.planning import Controller, MppiOptions, ReferencePath, learned_motions
from slipwise.planning.futures import sample_futures
from slipwise.planning.rollout import rollout
from slipwise.planning.start import Start

DT, PERIODS = 0.05, 40


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> sw.Model:
    path = write_car_log(tmp_path_factory.mktemp("car") / "car.csv", 120.0)
    return sw.calibrate(sw.open_log(path, options=LogOptions(vehicle="dart"))).model


def driving() -> np.ndarray:
    """Three rollouts of throttle and steering [3, K, 2]."""
    commands = np.zeros((3, PERIODS, 2))
    commands[0], commands[1] = (0.5, 0.3), (0.7, -0.6)
    commands[2] = np.repeat([(0.3, 0.5), (0.8, -0.9), (0.1, 0.2), (0.6, 0.0)], PERIODS // 4, axis=0)
    return commands


def test_each_rollout_starts_as_its_car_drives(model: sw.Model) -> None:
    commands = np.tile([0.5, 0.3], (2, PERIODS, 1))
    start = Start(drive=[(0.0, 0.0), (1.5, 0.6)], past=np.tile([0.5, 0.3], (2, 10, 1)))
    path = rollout(model, commands, DT, start=start, dtype=np.float32).path
    assert path is not None
    assert path.dtype == np.float32
    moved = np.hypot(path[0, 9], path[1, 9])
    assert moved[1] == pytest.approx(0.75, abs=0.05)
    assert moved[0] < 0.5 * moved[1]


def test_futures_of_a_car_spread_about_its_rollouts(model: sw.Model) -> None:
    start = Start(past=np.zeros((4, 2)))
    drawn = sample_futures(model, driving(), DT, samples=50, seed=1, start=start)
    path = rollout(model, driving(), DT, start=start, dtype=np.float64).path
    assert path is not None
    assert drawn.mean(axis=1)[:2, -1] == pytest.approx(path[:2, -1], abs=0.05)
    assert drawn.std(axis=1)[:2, -1].max() > 1e-3


def test_a_throttle_that_was_never_driven_is_unsure_in_rollouts_and_futures_as_in_predict(
    model: sw.Model,
) -> None:
    commands, start = np.tile([1.0, 0.2], (1, PERIODS, 1)), Start(past=np.zeros((4, 2)))
    rows = np.vstack(([-1.0, 0.0, 0.0], np.column_stack((DT * np.arange(PERIODS), commands[0]))))
    ahead = sw.predict(model, rows, horizon=DT * PERIODS, start=0.0).covariance[-1]
    found = rollout(model, commands, DT, start=start, covariance=True).covariance
    assert found is not None
    drawn = sample_futures(model, commands, DT, samples=400, seed=2, start=start)[:, :, -1, 0]
    assert np.sqrt(ahead[0, 0]) > 0.3
    assert np.sqrt(found[0, -1, 0]) == pytest.approx(np.sqrt(ahead[0, 0]), rel=0.1)
    assert drawn[0].std() == pytest.approx(np.sqrt(ahead[0, 0]), rel=0.2)


def test_speeds_in_place_of_throttle_are_refused(model: sw.Model) -> None:
    with pytest.raises(SettingsError, match="within"):
        rollout(model, 2.0 * np.ones((1, 4, 2)), DT)
    with pytest.raises(SettingsError, match="at most 1"):
        Controller(learned_motions(model), circle())
    mixed = [*learned_motions(model), replace(learned_motions(model)[0], car=None)]
    with pytest.raises(SettingsError, match="do not mix"):
        Controller(mixed, circle(), options=MppiOptions().for_car())


def circle() -> ReferencePath:
    around = np.linspace(-0.5 * np.pi, 1.5 * np.pi, 181)
    return ReferencePath(1.5 * np.column_stack((np.cos(around), 1.0 + np.sin(around))), 1.0)

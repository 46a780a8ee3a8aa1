# SPDX-License-Identifier: Apache-2.0
"""Slip that changes slowly is followed over the whole log, and the model stays what it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.logs import Log
from slipwise_thesis import _thesis

BEFORE, AFTER = (-0.02, -0.1), (-0.06, -0.4)  # edd-2: lon.V, ang.w
RANDOM_WALK = {"drift": "random-walk", "length": 100.0}


def changing_log() -> Log:
    """Two drives of two minutes, on one terrain and on another."""
    basis = _core.named_basis("edd-2")
    logs = [simulated_log(Drive(seed=k, basis=basis, alpha=slip)) for k, slip in ((1, BEFORE), (2, AFTER))]
    return Log(runs=tuple(replace(log.runs[0], name=f"run {k}") for k, log in enumerate(logs)))


def learned(**settings: object) -> Calibration:
    given = {"basis": "edd-2", "smoothing": RANDOM_WALK, "learn_clock_offset": False, **settings}
    return calibrate(changing_log(), input="wheel", settings=make_settings(given), smooth=True)


@pytest.fixture(scope="module")
def calibration() -> Calibration:
    return learned()


def test_smoothed_parameters_follow_the_ground(calibration: Calibration) -> None:
    course = calibration.smoothed
    assert course is not None
    assert course.names == ("lon.V", "ang.w")
    for run, slip in ((0, BEFORE), (1, AFTER)):
        at = np.flatnonzero(course.run == run)
        middle = at[len(at) // 4 : -len(at) // 4]
        assert course.mean[middle].mean(axis=0) == pytest.approx(slip, abs=0.03)
        sigmas = np.abs(course.mean[middle] - slip) / course.std[middle]
        assert np.mean(sigmas < 2.0) > 0.8


def test_a_longer_drift_length_follows_less() -> None:
    def spread(length: float) -> float:
        course = learned(smoothing=RANDOM_WALK | {"length": length}).smoothed
        assert course is not None
        return float(np.ptp(course.mean[:, 1]))

    assert spread(1e6) < 0.02 < 0.2 < spread(100.0)


def test_smoothing_changes_no_model(calibration: Calibration) -> None:
    settings = make_settings({"basis": "edd-2", "smoothing": RANDOM_WALK, "learn_clock_offset": False})
    alone = calibrate(changing_log(), input="wheel", settings=settings)
    assert alone.smoothed is None
    assert alone.model.content == calibration.model.content


def test_the_chain_is_the_robots_and_is_taken_as_learned() -> None:
    basis = _core.named_basis("edd-2")
    log = simulated_log(Drive(basis=basis, alpha=AFTER, lag=0.4, delay=0.2))
    course = calibrate(log, settings=make_settings({"basis": "edd-2"}), smooth=True).smoothed
    assert course is not None
    assert course.names == ("lon.V", "ang.w")
    assert course.mean.mean(axis=0) == pytest.approx(AFTER, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["average", *_thesis.estimator_names()])
def test_the_model_of_every_estimator_can_be_smoothed(name: str) -> None:
    course = learned(estimator=name).smoothed
    assert course is not None
    assert np.isfinite(course.mean).all()
    assert (course.std > 0.0).all()


def test_the_table_holds_every_window_and_parameter(calibration: Calibration, tmp_path: Path) -> None:
    course = calibration.smoothed
    assert course is not None
    path = course.save(tmp_path / "smoothed.csv")
    assert path.read_text().splitlines()[0] == "run,t_start,t_end,lon.V,std(lon.V),ang.w,std(ang.w)"
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 0], course.run)
    assert np.array_equal(rows[:, 1:3], np.column_stack((course.start, course.end)))
    assert np.array_equal(rows[:, 3::2], course.mean)
    assert np.array_equal(rows[:, 4::2], course.std)

# SPDX-License-Identifier: Apache-2.0
"""Terms of gravity are tried where the ground slopes, found there, and called unknown elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log
from sample_slopes import Hills, hilly_log

from slipwise.calibration import calibrate
from slipwise.calibration.settings import AUTO_BASES, make_settings
from slipwise.calibration.sloping_ground import SLOPE_BASES, for_the_ground_of, tilt_spread
from slipwise.logs.log import Log

GRAVITY_TERMS = ("lon.gx", "lat.gy", "ang.gx", "ang.gy")


def test_only_auto_on_a_log_whose_attitude_varies_tries_gravity() -> None:
    hilly, flat = hilly_log(1, Hills(seconds=10.0)), simulated_log(Drive(seconds=10.0))
    auto = make_settings({})
    assert for_the_ground_of(hilly, auto).auto.bases == [*AUTO_BASES, *SLOPE_BASES]
    for settings in ({"basis": "edd-2"}, {"auto": {"bases": ["edd-2"]}}):
        chosen = make_settings(settings)
        assert for_the_ground_of(hilly, chosen) is chosen
    assert for_the_ground_of(flat, auto) is auto
    assert tilt_spread(flat) == 0.0


def test_a_sensor_that_is_mounted_with_a_tilt_stands_on_level_ground() -> None:
    run = simulated_log(Drive(seconds=10.0)).runs[0]
    leaning = replace(run.poses, roll=np.full(len(run.poses), 0.2), pitch=np.full(len(run.poses), -0.1))
    assert tilt_spread(Log((replace(run, poses=leaning),))) < 1e-9


@pytest.mark.slow
def test_gravity_is_found_on_hills_and_predictions_are_better_for_it() -> None:
    log = hilly_log(3, Hills(seconds=200.0))
    with_gravity = calibrate(log)
    without = calibrate(log, settings=make_settings({"auto": {"bases": list(AUTO_BASES[:-1])}}))
    found = {p.name: p for p in with_gravity.model.content.parameters}
    truth = {"lon.gx": 0.06, "lat.gy": 0.12, "ang.gy": 0.05}
    for name, value in truth.items():
        assert abs(found[name].value - value) < 3.0 * found[name].std
        assert found[name].identifiable
    better, worse = with_gravity.model.content.verdict.held_out, without.model.content.verdict.held_out
    assert better is not None
    assert worse is not None
    assert better.position < 0.6 * worse.position
    assert better.heading < 0.6 * worse.heading


@pytest.mark.slow
def test_on_flat_ground_terms_of_gravity_are_called_not_identifiable() -> None:
    """Tried although `auto` would not: of a hundred drives, at most five may claim to know one."""
    claimed = 0
    for seed in range(100):
        log = hilly_log(seed, Hills(height=0.0, seconds=60.0))
        learned = calibrate(log, settings=make_settings({"basis": "odd-even-13"})).model.content.parameters
        claimed += any(p.identifiable for p in learned if p.name in GRAVITY_TERMS)
    assert claimed <= 5


def test_no_prediction_depends_on_an_attitude_that_is_measured_after_its_start() -> None:
    run = hilly_log(5, Hills(seconds=60.0)).runs[0]
    later = run.poses.t > 40.0
    roll, pitch = run.poses.roll, run.poses.pitch
    assert roll is not None
    assert pitch is not None
    tipped = replace(run.poses, roll=np.where(later, -roll, roll), pitch=np.where(later, 0.3, pitch))
    made = [calibrate(Log((each,))).predictions for each in (run, replace(run, poses=tipped))]
    for one, other in zip(*made, strict=True):
        before = one.t_start < 40.0
        assert before.any()
        assert not before.all()
        assert one.pose[before].tobytes() == other.pose[before].tobytes()
        assert one.covariance[before].tobytes() == other.covariance[before].tobytes()
        assert (one.pose[~before] != other.pose[~before]).any()

# SPDX-License-Identifier: Apache-2.0
"""A clock offset is never known better than the stamps of the wheel speeds support."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise.calibration import Settings, calibrate
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.drive import prepare_drive
from slipwise.calibration.learner import Belief
from slipwise.calibration.learning_run import start_learning
from slipwise.calibration.stamp_spacing import StampSpacing

SPACING = 0.05  # s


def test_poses_without_any_noise_do_not_tell_the_offset_to_microseconds() -> None:
    log = simulated_log(Drive(seconds=120.0, late=0.15, pose_std=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0)))
    model = calibrate(log, input="wheel", settings=Settings(basis="edd-2")).model
    (offset,) = (p for p in model.content.parameters if p.name == "clock_offset")
    windows = model.content.provenance.learned_windows
    assert offset.std >= 0.999 * SPACING / np.sqrt(12.0 * windows)
    assert offset.value == pytest.approx(0.15, abs=SPACING)


def correlations(belief: Belief) -> np.ndarray:
    deviations = np.sqrt(np.diag(belief.covariance))
    return belief.covariance / np.outer(deviations, deviations)


def test_what_is_surer_is_widened_with_its_correlations_and_what_is_not_stays() -> None:
    settings = Settings(basis="edd-2")
    drive = prepare_drive(simulated_log(Drive(seconds=60.0, late=0.15)), "wheel")
    windows = learning_windows(drive, "wheel", settings)
    belief = start_learning(settings, "wheel", windows).belief(len(windows))
    least = SPACING / np.sqrt(12.0 * len(windows))
    place = len(belief.mean) - 1
    for std, expected in ((0.01 * least, least), (3.0 * least, 3.0 * least)):
        scale = np.ones(len(belief.mean))
        scale[place] = std / np.sqrt(belief.covariance[place, place])
        given = replace(belief, covariance=belief.covariance * np.outer(scale, scale))
        wider = StampSpacing(windows).supported(given, len(windows))
        assert np.sqrt(wider.covariance[place, place]) == pytest.approx(expected, rel=0.01)
        np.testing.assert_allclose(correlations(wider), correlations(given), rtol=1e-9, atol=1e-12)

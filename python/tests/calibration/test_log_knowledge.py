# SPDX-License-Identifier: Apache-2.0
"""What a log says in the terms of a basis is what was learned there, with the prior it was learned under."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.from_prior import calibrate_from
from slipwise.calibration.log_knowledge import LogKnowledge

DRIVE = Drive(seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3), lag=0.3, delay=0.1)


@pytest.fixture(scope="module")
def known() -> LogKnowledge:
    found = calibrate_from(simulated_log(DRIVE), None, input="wheel")[1]
    assert found is not None
    return found


def test_each_basis_has_its_own_slip(known: LogKnowledge) -> None:
    joint = known.structures["joint"]
    slip = joint.bases["edd-2"].slip
    std = np.sqrt(np.diag(slip.covariance))
    np.testing.assert_allclose(slip.mean, DRIVE.alpha, atol=0.02)
    assert (np.abs(slip.mean - DRIVE.alpha) < 4.0 * std).all()
    assert (std < slip.prior_std).all()
    assert len(joint.bases["odd-even-10"].slip.mean) == 10
    assert len(joint.bases["none"].slip.mean) == 0
    assert sum(basis.weight for basis in joint.bases.values()) == pytest.approx(1.0)


def test_what_is_the_robots_has_names_and_its_prior(known: LogKnowledge) -> None:
    joint = known.structures["joint"]
    assert joint.robot_names == ("log_time_constant_v", "log_time_constant_omega", "clock_offset")
    assert joint.robot is not None
    assert joint.robot.prior_std.tolist() == [1.0, 1.0, 0.2]


def test_the_cascade_hands_out_its_actuator_where_it_was_kept() -> None:
    found = calibrate_from(simulated_log(DRIVE), None, input="command")[1]
    assert found is not None
    assert found.kept == "cascaded"
    cascaded = found.structures["cascaded"]
    assert "log_time_constant_v" in cascaded.robot_names
    assert cascaded.robot is not None
    at = cascaded.robot_names.index("log_delay_v")
    assert abs(cascaded.robot.mean[at] - np.log(0.1)) < 1.0
    assert {"joint", "cascaded"} <= found.structures.keys()


def test_other_estimators_say_nothing() -> None:
    settings = Settings(estimator="iekf", basis="edd-2")
    assert calibrate_from(simulated_log(DRIVE), None, input="wheel", settings=settings)[1] is None

# SPDX-License-Identifier: Apache-2.0
"""In MuJoCo a side wind, a towed load and a stuck wheel are found as forces, and slip stays what it was."""

from __future__ import annotations

import force_recovery
import numpy as np
import pytest

STRONGEST = {"side wind": "lat.abs(V)*cos(yaw)", "towed load": "lon.abs(V)", "stuck wheel": "ang.abs(V)"}


def test_a_shuttle_drives_both_ways_until_it_limps_ahead() -> None:
    drive = force_recovery.shuttle(1, 120.0, 60.0)
    later = drive.t > 75.0
    assert drive.v[drive.t < 60.0].min() < -0.3
    assert drive.v[later].min() > 0.0
    assert np.abs(drive.omega[later]).max() <= 0.15


@pytest.mark.slow
@pytest.mark.parametrize("case", force_recovery.CASES, ids=lambda case: case.name)
def test_the_force_is_within_three_sigma_and_slip_is_not_bent(case: force_recovery.Case) -> None:
    pytest.importorskip("mujoco")
    got = force_recovery.recover(case, seed=3)
    assert np.abs(got.z).max() < 3.0
    assert "A force pushes the robot" in got.sentence
    without, beside = got.bent
    assert beside < 3.0
    if case.limps:  # what begins to drag in a drive would pass for slip
        assert without > 5.0
    else:
        assert got.error[1] < 0.8 * got.error[0]
    place = got.names.index(STRONGEST[case.name])
    assert np.sign(got.found[place]) == np.sign(got.truth[place])

# SPDX-License-Identifier: Apache-2.0
"""A force beside slip: what the verdict says where there is one, where there is none, where nobody knows."""

from __future__ import annotations

import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.errors import SettingsError

SLIP = _core.named_basis("drive-5")
BOTH = _core.with_force(SLIP, _core.ForceFrame.Body)
LEARN = {"frame": "body"}


def learned(*, speeds: tuple[float, float] = (-1.0, 1.5), force: float = 0.0, seed: int = 1) -> Calibration:
    """Learn two minutes of slip and a force to the left."""
    true = {"lon.V": -0.05, "ang.w": -0.2, "lat.abs(V)": force, "lat.abs(w)": 0.5 * force}
    names = [info.name for info in _core.MotionModel(BOTH, False, False).parameters]
    alpha = tuple(true.get(name, 0.0) for name in names)
    log = simulated_log(Drive(basis=BOTH, alpha=alpha, speeds=speeds, seed=seed, slip_psd=(1e-4, 1e-4, 1e-4)))
    return calibrate(log, input="wheel", settings=make_settings({"body_force": LEARN}))


def test_a_force_is_found_and_slip_is_not_bent_by_it() -> None:
    found = learned(force=0.04)
    side, slip = found.model["lat.abs(V)"], found.model["lon.V"]
    assert abs(side.value - 0.04) < 3.0 * side.std < 0.03
    assert abs(slip.value + 0.05) < 3.0 * slip.std
    assert "A force pushes the robot" in found.verdict.force
    assert found.model.content.verdict.force == found.verdict.force
    assert found.model.content.body_force is not None


def test_a_drive_one_way_does_not_tell_a_force_ahead_from_slip() -> None:
    found = learned(speeds=(0.3, 1.5))
    assert "ahead (+) or back (-): not identifiable" in found.verdict.force
    assert "lon.abs(V)" in found.verdict.not_identifiable
    assert any("forwards and backwards" in advice for advice in found.verdict.advice)


def test_without_the_option_nothing_is_said_of_a_force() -> None:
    log = simulated_log(Drive(seconds=30.0))
    found = calibrate(log, input="wheel")
    assert found.verdict.force == ""
    assert found.model.content.body_force is None


@pytest.mark.slow
def test_drives_without_a_force_are_rarely_said_to_have_one() -> None:
    claims = ["A force pushes" in learned(seed=100 + seed).verdict.force for seed in range(12)]
    assert sum(claims) <= 1


def test_other_estimators_and_remembered_surfaces_refuse_a_force() -> None:
    log = simulated_log(Drive(seconds=30.0))
    with pytest.raises(SettingsError, match="body force"):
        calibrate(log, settings=make_settings({"body_force": LEARN, "estimator": "iekf", "basis": "edd-2"}))

# SPDX-License-Identifier: Apache-2.0
"""What a drive leaves open is said, with its confounded parameters and the driving that would help."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core, open_log
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.calibration.identifiability import (
    Confounded,
    advice_for_pairs,
    confounded,
    not_identifiable,
    timing_words,
)
from slipwise.calibration.learner import Posterior
from slipwise.logs import Log
from slipwise.models import load_model

LEARN = {"basis": "edd-2", "sensor_extrinsics": {"learn": True}}


def learned(log: Log, source: str, given: dict[str, object]) -> Calibration:
    return calibrate(log, input=source, settings=make_settings(given))


def straight(**given: object) -> Log:
    return simulated_log(replace(Drive(seconds=60.0, speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0)), **given))


def posterior(motion: _core.MotionModel, correlation: float) -> Posterior:
    """A posterior whose first two parameters go together."""
    covariance = np.eye(motion.size)
    covariance[0, 1] = covariance[1, 0] = correlation
    ratio = np.full(motion.size, 0.1)
    return Posterior(
        motion, np.zeros(motion.size), covariance, np.ones(3), np.ones(motion.size), ratio, np.ones(1)
    )


def test_pairs_that_go_together_are_named() -> None:
    motion = _core.MotionModel(_core.named_basis("edd-2"), True, False)
    assert confounded(posterior(motion, 0.89)) == ()
    (pair,) = confounded(posterior(motion, -0.95))
    assert pair == Confounded("lon.V", "ang.w", pytest.approx(-0.95))
    assert str(pair) == "lon.V and ang.w (-0.95)"
    assert not_identifiable(posterior(motion, -0.95)) == ()


def test_a_lever_arm_that_a_straight_drive_cannot_show_is_said() -> None:
    verdict = learned(straight(), "wheel", LEARN).verdict
    assert {"sensor_x", "sensor_y"} <= set(verdict.not_identifiable)
    assert "sensor_yaw" not in verdict.not_identifiable
    assert any("Turn on the spot both ways" in text and "sensor_x" in text for text in verdict.advice)


def test_a_sensor_and_the_slip_it_looks_like_are_named_with_what_to_do(tmp_path: Path) -> None:
    log = simulated_log(Drive(seconds=90.0))
    result = learned(log, "wheel", {"basis": "full-linear-6", "sensor_extrinsics": {"learn": True}})
    pairs = {frozenset((pair.first, pair.second)) for pair in result.verdict.confounded}
    confounded = (("sensor_x", "lat.w"), ("sensor_y", "lon.w"), ("sensor_yaw", "lat.V"))
    assert {frozenset(pair) for pair in confounded} <= pairs
    assert any("give its place under [sensor_extrinsics]" in text for text in result.verdict.advice)
    again = load_model(result.model.save(tmp_path / "m.yaml")).content.verdict
    assert [(p.first, p.second) for p in again.confounded] == [
        (p.first, p.second) for p in result.verdict.confounded
    ]
    assert again.timing == result.verdict.timing


def test_lag_and_delay_of_one_channel_alone_trade_places() -> None:
    advice = advice_for_pairs(
        (
            Confounded("log_delay_v", "log_time_constant_v", -0.97),
            Confounded("log_time_constant_v", "log_delay_omega", 0.95),
        )
    )
    assert len(advice) == 1
    assert advice[0].endswith("delay_v and time_constant_v (-0.97).")


def test_it_is_said_which_delay_holds_which_clock_offset() -> None:
    basis = _core.named_basis("edd-2")
    alone = timing_words(_core.MotionModel(basis, True, False), (), wheels_logged=False)
    assert "this log cannot separate the two" in alone
    assert "Wheel speeds in the log would" in alone
    advised = timing_words(
        _core.MotionModel(basis, True, False), (), wheels_logged=False, wheels_advice="give --wheel-radius"
    )
    assert "Wheel speeds in the log would; give --wheel-radius." in advised
    unused = timing_words(_core.MotionModel(basis, True, False), (), wheels_logged=True)
    assert "Wheel speeds in the log would" not in unused
    cascade = timing_words(_core.MotionModel.with_response(basis, True), (), wheels_logged=True)
    assert "from commands to wheel speeds" in cascade
    assert "clock_offset is how much later poses come than wheel speeds: they are stamped late, or" in cascade
    assert timing_words(_core.MotionModel(basis, False, False), (), wheels_logged=False) == ""


def test_a_clock_offset_that_steady_driving_cannot_show_stays_at_its_prior() -> None:
    result = learned(straight(late=0.4), "wheel", {"basis": "edd-2"})
    (offset,) = (p for p in result.model.content.parameters if p.name == "clock_offset")
    assert not offset.identifiable
    assert abs(offset.value) < 0.5 * offset.prior_std
    assert "This drive does not determine it" in result.verdict.timing


def test_a_real_clock_offset_is_not_guessed_beyond_its_prior(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "f1tenth" / "DS3.csv.gz")
    result = learned(log, "wheel", {})
    (offset,) = (p for p in result.model.content.parameters if p.name == "clock_offset")
    assert abs(offset.value) < 2.0 * offset.prior_std
    assert offset.std < offset.prior_std

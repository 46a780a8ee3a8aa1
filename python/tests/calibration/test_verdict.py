# SPDX-License-Identifier: Apache-2.0
"""The verdict never claims more than the held-out windows show, and says which drive would help."""

from __future__ import annotations

import math

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.calibration.identifiability import drives_for
from slipwise.calibration.verdict import FEWEST_WINDOWS, Judgement
from slipwise.models.parameter_table import physical_name
from slipwise.models.schema import HeldOut

SLIP = _core.named_basis("edd-2")


def verdict_of(drive: Drive, basis: str = "auto", input_name: str = "wheel") -> Calibration:
    return calibrate(simulated_log(drive), input=input_name, settings=make_settings({"basis": basis}))


def judgement(position: tuple[float, float, float], heading: tuple[float, float, float]) -> Judgement:
    held_out = HeldOut(
        horizon=5.0, windows=9, position=1.0, heading=1.0, plain_position=1.0, plain_heading=1.0
    )
    return Judgement(held_out, position, heading)


def test_drive_that_slips_gives_a_good_verdict_with_its_figures() -> None:
    result = verdict_of(Drive(seconds=120.0, basis=SLIP, alpha=(-0.1, -0.4)))
    held_out = result.model.content.verdict.held_out
    assert result.verdict.good
    assert held_out is not None
    assert held_out.position < 0.2 * held_out.plain_position
    figures = f"{held_out.position:.3g} m and {held_out.heading:.3g} rad after 5 s"
    assert figures in result.verdict.sentence
    assert result.model.content.verdict.sentence == result.verdict.sentence


def test_straight_drive_at_constant_speed_names_what_it_does_not_determine() -> None:
    drive = Drive(seconds=60.0, basis=SLIP, alpha=(-0.1, -0.3), speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0))
    result = verdict_of(drive, "full-linear-6")
    assert set(result.verdict.undetermined) >= {"lon.w", "lat.w", "ang.w", "clock_offset"}
    assert not set(result.verdict.undetermined) & {"lon.V", "lat.V", "ang.V"}
    advice = " ".join(result.verdict.advice)
    assert "Turn both ways at several yaw rates, in place too (for lon.w, lat.w, ang.w)." in advice
    assert "steady driving cannot show a clock offset (for clock_offset)" in advice
    stated = {p.name for p in result.model.content.parameters if not p.determined}
    assert stated == set(result.verdict.undetermined)
    assert result.model.mean[1] == pytest.approx(0.0, abs=0.05)  # what is not determined stays at the prior


def test_commands_that_never_change_do_not_determine_lag_and_delay() -> None:
    drive = Drive(seconds=60.0, speeds=(1.0, 1.0), yaw_rates=(0.3, 0.3), lag=0.3)
    result = verdict_of(drive, "edd-2", "command")
    assert "log_delay_omega" in result.verdict.undetermined
    assert any("Change the yaw rate in steps" in text for text in result.verdict.advice)


@pytest.mark.parametrize("seed", range(8))
def test_perfect_robot_under_noise_is_not_said_to_be_improved(seed: int) -> None:
    drive = Drive(seconds=90.0, seed=seed, pose_std=(0.02, 0.01), slip_psd=(0.0, 0.0, 0.0))
    result = verdict_of(drive)
    held_out = result.model.content.verdict.held_out
    assert held_out is not None
    assert held_out.position < 1.15 * held_out.plain_position + 0.01
    if result.verdict.good:
        assert held_out.position * held_out.heading < held_out.plain_position * held_out.plain_heading
    else:
        assert "does not beat the plain model" in result.verdict.sentence


def test_what_the_average_of_poses_gains_is_not_the_model_s_merit() -> None:
    learned = verdict_of(Drive(seconds=90.0, seed=1, pose_std=(0.02, 0.01), slip_psd=(1e-9, 1e-9, 1e-9)))
    held_out = learned.model.content.verdict.held_out
    assert held_out is not None
    assert held_out.position < 0.9 * held_out.plain_position  # by where predictions start
    assert not learned.verdict.good
    assert "It gains by averaging the last poses, not by what it learned." in learned.verdict.sentence


def test_claims_about_perfect_robots_are_as_rare_as_chance() -> None:
    drives = [Drive(seconds=90.0, seed=s, pose_std=(0.02, 0.01), slip_psd=(0.0, 0.0, 0.0)) for s in range(30)]
    assert sum(verdict_of(drive, "edd-2").verdict.good for drive in drives) <= 3


def test_too_little_driving_says_so() -> None:
    result = verdict_of(Drive(seconds=3.0, basis=SLIP, alpha=(-0.1, -0.4)))
    assert not result.verdict.good
    assert result.verdict.sentence.startswith("Too little driving to judge: 2 held-out windows of 1 s")
    assert result.verdict.advice[0] == "Record a longer drive."


def test_longest_horizon_with_enough_windows_is_judged() -> None:
    result = verdict_of(Drive(seconds=20.0, basis=SLIP, alpha=(-0.1, -0.4)))
    held_out = result.model.content.verdict.held_out
    assert held_out is not None
    assert (held_out.horizon, held_out.windows) == (2.0, 5)
    assert held_out.windows >= FEWEST_WINDOWS
    assert set(result.model.content.noise.tails) == {1.0, 2.0, 5.0}


@pytest.mark.parametrize(
    ("position", "heading", "beats"),
    [
        ((0.5, 0.4, 0.6), (0.5, 0.4, 0.6), True),
        ((0.5, 0.4, 0.6), (1.1, 0.8, 1.4), True),  # heading is perhaps as before
        ((0.5, 0.4, 0.6), (1.3, 1.1, 1.5), False),  # heading is clearly worse
        ((0.95, 0.8, 1.1), (0.97, 0.9, 1.05), False),  # nothing beyond chance
        ((0.9, 0.8, 0.99), (1.2, 0.9, 1.5), False),  # worse on the whole
        ((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), False),
        ((math.nan,) * 3, (0.5, 0.4, 0.6), True),  # the plain position is never wrong
        ((math.nan,) * 3, (math.nan,) * 3, False),
    ],
)
def test_plain_model_is_beaten_only_beyond_chance(
    position: tuple[float, float, float], heading: tuple[float, float, float], beats: bool
) -> None:
    assert judgement(position, heading).beats_plain is beats


def test_every_parameter_of_every_basis_has_a_drive_that_determines_it() -> None:
    for name in _core.basis_names():
        model = _core.MotionModel.with_response(_core.named_basis(name), True).with_mount(True)
        for info in model.parameters:
            advice = drives_for((info.name,))
            assert len(advice) == 1
            assert advice[0].endswith(f"(for {physical_name(info.name)}).")
    assert drives_for(()) == ()


def test_verdict_reads_as_sentences() -> None:
    verdict = verdict_of(Drive(seconds=3.0)).verdict
    assert str(verdict) == " ".join((verdict.sentence, *verdict.advice))
    assert str(verdict).endswith(".")
    assert np.all([text.endswith(".") for text in verdict.advice])

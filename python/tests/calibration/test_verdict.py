# SPDX-License-Identifier: Apache-2.0
"""The verdict never claims more than the held-out windows show, and says which drive would help."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import circular, sound_log, stopped
from judgements import BETTER, TRUE, ellipsoids, judged
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.calibration.calibrate import model_of
from slipwise.calibration.identifiability import drives_for
from slipwise.calibration.judgement import FEWEST_WINDOWS
from slipwise.calibration.verdict import Identified, LogFacts, give_verdict
from slipwise.errors import LogError
from slipwise.logs import Log
from slipwise.logs.findings.finding import Finding
from slipwise.models.parameter_table import physical_name
from slipwise.models.summary import summarise

SLIP = _core.named_basis("edd-2")


def verdict_of(drive: Drive, basis: str = "auto", input_name: str = "wheel") -> Calibration:
    return calibrate(simulated_log(drive), input=input_name, settings=make_settings({"basis": basis}))


def test_drive_that_slips_gives_a_good_verdict_with_its_figures() -> None:
    result = verdict_of(Drive(seconds=120.0, basis=SLIP, alpha=(-0.1, -0.4)))
    held_out = result.model.content.verdict.held_out
    assert result.verdict.good
    assert held_out is not None
    assert held_out.position < 0.2 * held_out.baseline_position
    figures = f"misses by {held_out.position:.3g} m and {held_out.heading:.3g} rad after 5 s, "
    assert figures in result.verdict.sentence
    assert result.model.content.verdict.sentence == result.verdict.sentence


def test_straight_drive_at_constant_speed_names_what_it_does_not_determine() -> None:
    drive = Drive(seconds=60.0, basis=SLIP, alpha=(-0.1, -0.3), speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0))
    result = verdict_of(drive, "full-linear-6")
    assert set(result.verdict.not_identifiable) >= {"lon.w", "lat.w", "ang.w", "clock_offset"}
    assert not set(result.verdict.not_identifiable) & {"lon.V", "lat.V", "ang.V"}
    advice = " ".join(result.verdict.advice)
    assert "Turn both ways at several yaw rates, in place too (for lon.w, lat.w, ang.w)." in advice
    assert "steady driving cannot show a clock offset (for clock_offset)" in advice
    stated = {p.name for p in result.model.content.parameters if not p.identifiable}
    assert stated - {"log_time_constant_v", "log_time_constant_omega"} == set(result.verdict.not_identifiable)
    assert result.model.mean[1] == pytest.approx(0.0, abs=0.05)  # what is not determined stays at the prior


def test_straight_drives_are_not_refused_for_their_headings_and_turns_in_place_not_for_their_positions(
    subtests: pytest.Subtests,
) -> None:
    for name, speeds, yaw_rates in (
        ("straight", (0.2, 1.0), (0.0, 0.0)),
        ("in place", (0.0, 0.0), (-1.0, 1.0)),
    ):
        for seed in range(6):
            with subtests.test(name, seed=seed):
                drive = Drive(
                    seed=seed,
                    basis=SLIP,
                    alpha=(-0.05, -0.3),
                    speeds=speeds,
                    yaw_rates=yaw_rates,
                    pose_std=(0.01, 0.005),
                    slip_psd=(0.0, 0.0, 0.0),
                )
                assert verdict_of(drive, input_name="command").verdict.good


def test_turns_of_another_robot_are_told_by_their_headings() -> None:
    turns = simulated_log(Drive(speeds=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0))).runs[0]
    other = simulated_log(Drive(seed=2, speeds=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0))).runs[0]
    log = Log(runs=(replace(turns, poses=other.poses, wheels=None),))
    verdict = calibrate(log, input="command", settings=make_settings({"basis": "edd-2"})).verdict
    assert not verdict.good
    assert " rad after" in verdict.sentence.split("the model by")[0]


def test_a_robot_that_is_carried_away_while_it_turns_is_not_explained_by_its_turns() -> None:
    run = simulated_log(Drive(basis=SLIP, alpha=(0.0, -0.3), speeds=(0.0, 0.0))).runs[0]
    away = np.interp(run.poses.t, np.arange(0.0, 200.0, 7.0), np.random.default_rng(0).normal(0.0, 2.0, 29))
    log = Log(runs=(replace(run, poses=replace(run.poses, x=run.poses.x + away)),))
    verdict = calibrate(log, input="command", settings=make_settings({"basis": "edd-2"})).verdict
    assert "the commands do not explain the poses" in verdict.sentence


def test_commands_that_never_change_do_not_determine_lag_and_delay() -> None:
    drive = Drive(seconds=60.0, speeds=(1.0, 1.0), yaw_rates=(0.3, 0.3), lag=0.3)
    result = verdict_of(drive, "edd-2", "command")
    assert "log_delay_omega" in result.verdict.not_identifiable
    assert any("Change the yaw rate in steps" in text for text in result.verdict.advice)


def test_perfect_robot_under_noise_is_not_said_to_be_improved(subtests: pytest.Subtests) -> None:
    for seed in range(8):
        with subtests.test(seed=seed):
            drive = Drive(seconds=90.0, seed=seed, pose_std=(0.02, 0.01), slip_psd=(0.0, 0.0, 0.0))
            result = verdict_of(drive)
            held_out = result.model.content.verdict.held_out
            assert held_out is not None
            assert held_out.position < 1.15 * held_out.baseline_position + 0.01
            if result.verdict.good:
                assert (
                    held_out.position * held_out.heading
                    < held_out.baseline_position * held_out.baseline_heading
                )
            else:
                assert "does not beat the kinematic baseline: " in result.verdict.sentence


@pytest.mark.slow
def test_claims_about_perfect_robots_are_as_rare_as_chance() -> None:
    drives = [Drive(seconds=90.0, seed=s, pose_std=(0.02, 0.01), slip_psd=(0.0, 0.0, 0.0)) for s in range(30)]
    assert sum(verdict_of(drive, "edd-2").verdict.good for drive in drives) <= 3


def test_too_little_driving_says_so() -> None:
    result = verdict_of(Drive(seconds=3.0, basis=SLIP, alpha=(-0.1, -0.4)))
    assert not result.verdict.good
    assert result.verdict.sentence.startswith("Too little driving to judge: 2 held-out segments of 1 s")
    assert "at the very least 8 segments of 1 s, where this log has 3." in result.verdict.advice[0]


def test_longest_horizon_with_enough_windows_is_judged() -> None:
    result = verdict_of(Drive(seconds=20.0, basis=SLIP, alpha=(-0.1, -0.4)))
    held_out = result.model.content.verdict.held_out
    assert held_out is not None
    assert (held_out.horizon, held_out.segments) == (2.0, 5)
    assert held_out.segments >= FEWEST_WINDOWS
    assert set(result.model.content.noise.student_t) == {1.0, 2.0, 5.0}


def test_every_parameter_of_every_basis_has_a_drive_that_determines_it() -> None:
    for name in _core.basis_names():
        model = _core.MotionModel.with_response(_core.named_basis(name), True).with_extrinsics(True)
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


def test_a_log_that_contradicts_itself_gives_no_good_model_and_no_talk_of_slip() -> None:
    log = stopped(sound_log(), 0.0, 0.01)
    result = calibrate(log, input="wheel", settings=make_settings({"basis": "edd-2"}))
    assert not result.verdict.good
    assert result.verdict.sentence.startswith("Do not use this model: the robot does not move although its")
    assert result.verdict.sentence.count("m and") == 0  # errors of such a model mean nothing
    assert result.verdict.advice[0].startswith("It stands still from ")
    assert result.verdict.timing == ""
    assert len(result.model.content.verdict.contradictions) == 1
    assert summarise(result.model).sentences == (
        "What was learned is not slip: poses and inputs of the log contradict each other.",
    )


def test_poses_that_integrate_the_wheels_give_no_good_model() -> None:
    log = circular(sound_log())
    for name in ("command", "wheel"):
        verdict = calibrate(log, input=name, settings=make_settings({"basis": "edd-2"})).verdict
        assert not verdict.good
        assert "the poses carry no information of their own" in verdict.sentence
        assert any(text.startswith("Record poses of another source") for text in verdict.advice)


def test_a_log_that_no_model_can_hold_is_an_error_that_names_the_cause() -> None:
    learned = calibrate(sound_log(), input="command", settings=make_settings({"basis": "edd-2"})).model
    cause = Finding("backward-poses", "the poses move backwards", ("Give --command-scale -1,1.",))
    rows = [p.model_copy(update={"value": 9.0}) for p in learned.content.parameters]
    content = learned.content.model_copy(update={"parameters": rows})
    with pytest.raises(LogError, match=r"no robot explains this log: the poses move .*command-scale -1,1"):
        model_of(content, Log(runs=()), (cause,))
    with pytest.raises(LogError, match=r"a lag or delay is longer than 1000 s: check that poses and inputs"):
        model_of(content, Log(runs=()), ())


def facts(contradictions: tuple[Finding, ...] = ()) -> LogFacts:
    return LogFacts(contradictions, (), "command", positions=False, clocks_compared=False)


def test_a_verdict_against_its_own_figures_says_why() -> None:
    judgement = judged((0.91, 0.72, 1.2), (0.72, 0.5, 1.1), windows=10)
    verdict = give_verdict(judgement, Identified(2, ()), facts())
    assert not verdict.good
    assert "hold 1 (position 0.910, 0.720 to 1.20; heading 0.720, 0.500 to 1.10)" in verdict.sentence
    assert "(10 held-out segments)" in verdict.sentence
    assert verdict.advice[0].startswith(
        "Record a longer drive: 10 held-out segments of 5 s tell little; 20 take"
    )
    many = give_verdict(judged((0.99, 0.9, 1.1), (1.0, 0.9, 1.1), windows=60), Identified(2, ()), facts())
    assert many.advice[0].startswith("This robot follows its commands as they are")


def test_errors_that_hide_a_slip_are_no_sign_of_a_robot_without_one() -> None:
    chance = judged((0.99, 0.9, 1.1), (1.0, 0.9, 1.1), windows=49)  # errors of 1 m and 1 rad
    (text, *_) = give_verdict(replace(chance, commanded=(4.0, 1.0)), Identified(2, ()), facts()).advice
    assert "hide a steady slip of 10 % of the speed or 40 % of the turns" in text
    assert "Record poses with less noise" in text
    assert "use the kinematic baseline" not in text
    for commanded in ((40.0, 20.0), (40.0, 0.1)):  # small errors, and a drive that never turns
        clear = give_verdict(replace(chance, commanded=commanded), Identified(2, ()), facts())
        assert clear.advice[0].startswith("This robot follows its commands as they are")


@pytest.mark.parametrize("seed", range(3))
def test_a_robot_that_slips_under_noise_is_not_said_to_follow_its_wheels(seed: int) -> None:
    noisy = Drive(seconds=240.0, seed=seed, basis=SLIP, alpha=(-0.05, -0.1), pose_std=(0.8, 0.6))
    advice = " ".join(verdict_of(noisy).verdict.advice)
    assert "as they are: use the kinematic baseline" not in advice
    exact = replace(noisy, alpha=(0.0, 0.0), pose_std=(0.005, 0.002))
    result = verdict_of(exact)
    assert result.verdict.good or "This robot follows its wheels as they are" in result.verdict.advice[0]


def test_a_worse_error_is_named_with_how_much_worse_it_is() -> None:
    verdict = give_verdict(judged((1.54, 0.8, 2.4), (0.5, 0.4, 0.6)), Identified(2, ()), facts())
    assert not verdict.good
    assert (
        "does not beat the kinematic baseline: its position error is 1.54 times as large." in verdict.sentence
    )


def test_an_error_that_is_larger_by_chance_perhaps_is_a_reservation_where_it_was_driven() -> None:
    larger = judged((1.06, 0.9, 1.2), BETTER)
    for commanded, reservations in (
        ((2.0, 0.5), ("Its position error is 1.06 times the baseline's, which may be chance.",)),
        ((0.1, 0.5), ()),
    ):
        verdict = give_verdict(replace(larger, commanded=commanded), Identified(2, ()), facts())
        assert (verdict.good, verdict.reservations) == (True, reservations)


def test_inputs_that_do_not_explain_the_motion_give_no_good_model_though_it_beats_the_baseline() -> None:
    verdict = give_verdict(judged(BETTER, BETTER, still=1.05), Identified(2, ()), facts())
    assert not verdict.good
    assert "the commands do not explain the poses. They explain 0 % of the motion" in verdict.sentence
    assert "standing still misses by 1.00 m after 2 s, the model by 1.05 m" in verdict.sentence
    assert verdict.advice[0].startswith("Check that commands and poses come from the same robot, drive")
    half = give_verdict(judged(BETTER, BETTER, still=0.52), Identified(2, ()), facts())
    assert not half.good
    assert "They explain 48 % of the motion" in half.sentence
    assert give_verdict(judged(BETTER, BETTER, still=0.45), Identified(2, ()), facts()).good


def test_ellipsoids_that_are_not_true_are_said_and_a_good_verdict_is_not_plainly_good() -> None:
    small = ellipsoids(0.6, nis=127.0, factor=42.0)
    verdict = give_verdict(judged(BETTER, BETTER, small), Identified(2, ()), facts())
    assert verdict.good
    assert verdict.reservations == (small.sentence(),)
    assert "the 95 % ellipsoids hold 18 of 30 (60 %) held-out segments (mean NIS 127" in verdict.sentence
    assert verdict.advice[0].startswith("Multiply predicted covariances by 42 ")
    plain = give_verdict(judged(BETTER, BETTER, TRUE), Identified(2, ()), facts())
    assert (plain.good, plain.reservations, plain.advice) == (True, (), ())


def test_a_model_that_is_mostly_outside_its_ellipsoids_is_not_good() -> None:
    untrue = ellipsoids(0.3, nis=1184.0)
    verdict = give_verdict(judged(BETTER, BETTER, untrue), Identified(2, ()), facts())
    assert not verdict.good
    assert "its uncertainty is not that of its errors" in verdict.sentence
    assert "hold 9 of 30 (30 %) held-out segments" in verdict.sentence


def test_heavy_tails_are_said_and_covariances_that_hold_what_they_should_are_not_to_be_multiplied() -> None:
    verdict = give_verdict(
        judged(BETTER, BETTER, ellipsoids(94 / 99, nis=11.0, segments=99)), Identified(2, ()), facts()
    )
    assert verdict.good
    assert (
        "heavy tails: the 95 % ellipsoids hold 94 of 99 (95 %) held-out segments" in verdict.reservations[0]
    )
    assert "the farthest has a NIS of 44.0, and the mean is 11.0" in verdict.reservations[0]
    assert "Multiply" not in " ".join(verdict.advice)


def test_a_short_stop_qualifies_a_good_verdict() -> None:
    stop = Finding("does-not-move", "the robot stops", ("Cut it out.",), spoils=False, reserves=True)
    verdict = give_verdict(judged(BETTER, BETTER), Identified(2, ()), facts(contradictions=(stop,)))
    assert verdict.good
    assert verdict.reservations == ("The robot stops.",)
    assert verdict.contradictions == ()
    assert verdict.advice == ("Cut it out.",)

# SPDX-License-Identifier: Apache-2.0
"""Scores say what they are called, and wrong options are refused with advice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log, simulated_run, steady_run

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.statistics import held_out_half
from slipwise.errors import LogError, SettingsError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.evaluation.result import Score
from slipwise.logs import Log, LogOptions, Source, empty_poses
from slipwise.logs.corrections import scaled_inputs

SLIP = _core.named_basis("edd-2")
DRIVE = Drive(seconds=60.0, basis=SLIP, alpha=(-0.1, -0.4))

LEVEL_BASES = tuple(name for name in _core.basis_names() if name not in ("odd-even-13", "drive-9", "omni-8"))


@pytest.fixture(scope="module")
def log() -> Log:
    return replace(simulated_log(DRIVE), sources=(Source("drive.csv", "ab" * 32, "csv", 1200),))


@pytest.fixture(scope="module")
def evaluation(log: Log) -> Evaluation:
    options = EvaluationOptions(
        methods=("none", "vendor", "edd-2", "auto"), vendor_wheel_separation_multiplier=1.0 / 0.6
    )
    return evaluate(log, input="wheel", options=options)


def test_scores_are_those_of_the_predictions_in_the_second_half(evaluation: Evaluation) -> None:
    for p in evaluation.predictions:
        score = evaluation.score(p.method, p.horizon)
        half = slice(len(p) // 2, None)
        dx, dy, dyaw = (p.measured - p.pose)[half].T
        position, heading = np.sqrt(dx**2 + dy**2), np.abs(np.arctan2(np.sin(dyaw), np.cos(dyaw)))
        assert score.windows == len(p) - len(p) // 2
        assert score.position.mean == pytest.approx(position.mean())
        assert score.position.rmse == pytest.approx(np.sqrt((position**2).mean()))
        assert score.position.median == pytest.approx(np.median(position))
        assert score.heading.mean == pytest.approx(heading.mean())
        assert score.heading.p95 == pytest.approx(np.quantile(heading, 0.95))
        assert score.position.low <= score.position.mean <= score.position.high
        errors = (p.measured - p.pose)[half]
        errors[:, 2] = np.arctan2(np.sin(dyaw), np.cos(dyaw))
        nis = [e @ np.linalg.inv(c) @ e for e, c in zip(errors, p.covariance[half], strict=True)]
        assert score.nis == pytest.approx(np.mean(nis))


def test_ratios_are_relative_to_the_baseline_model_and_to_the_best_rival(evaluation: Evaluation) -> None:
    scores = {m: evaluation.score(m, 2.0) for m in evaluation.methods}
    plain = scores["none"].position.mean
    assert scores["none"].position_ratio[0] == pytest.approx(1.0)
    assert scores["auto"].position_ratio[0] == pytest.approx(scores["auto"].position.mean / plain)
    best = min(scores[m].heading.mean for m in ("vendor", "edd-2"))
    assert scores["auto"].heading_to_rival == pytest.approx(scores["auto"].heading.mean / best)


def test_ratios_stand_where_the_baseline_model_was_not_asked_for(log: Log, evaluation: Evaluation) -> None:
    alone = evaluate(log, input="wheel", options=EvaluationOptions(horizons=(2.0,), methods=("edd-2",)))
    asked = evaluation.score("edd-2", 2.0)
    assert alone.score("edd-2", 2.0).position_ratio == asked.position_ratio
    assert alone.score("edd-2", 2.0).heading_ratio == asked.heading_ratio
    assert {p.method for p in alone.predictions} == {"edd-2"}


def test_vendor_multiplier_that_is_true_leaves_no_heading_error(evaluation: Evaluation) -> None:
    assert evaluation.score("vendor", 5.0).heading.mean < 0.03
    assert evaluation.score("none", 5.0).heading.mean > 0.2


def test_in_sample_residual_is_the_smaller_one(evaluation: Evaluation) -> None:
    score = evaluation.score("edd-2", 1.0)
    assert 0.0 < score.in_sample_position < score.position.mean


def test_all_methods_that_apply_are_compared_by_default(log: Log) -> None:
    methods = evaluate(log, input="wheel", options=EvaluationOptions(horizons=(2.0,))).methods
    assert methods == ("none", *LEVEL_BASES, "batch", "auto")


def test_the_estimator_of_the_settings_is_compared_by_default(log: Log) -> None:
    options, settings = EvaluationOptions(horizons=(2.0,)), make_settings({"estimator": "iekf"})
    methods = evaluate(log, input="wheel", settings=settings, options=options).methods
    assert methods == ("none", *LEVEL_BASES, "batch", "iekf", "auto")


def test_wrong_options_are_refused_with_advice(log: Log, subtests: pytest.Subtests) -> None:
    for options, message in [
        (EvaluationOptions(methods=("none", "magic")), "unknown method 'magic' .*known are none, vendor"),
        (EvaluationOptions(methods=("vendor",)), "needs a multiplier .*--vendor-wheel-separation-multiplier"),
        (EvaluationOptions(methods=("vendor",), vendor_wheel_separation_multiplier=0.0), "must be positive"),
        (
            EvaluationOptions(methods=("vendor",), vendor_wheel_separation_multiplier=float("nan")),
            "must be positive",
        ),
        (EvaluationOptions(methods=("model",)), "needs a model file .*--model FILE"),
        (EvaluationOptions(horizons=()), "horizons must be positive seconds"),
        (EvaluationOptions(horizons=(1.0, -2.0)), "horizons must be positive seconds"),
        (EvaluationOptions(horizons=(float("nan"),)), "horizons must be positive seconds"),
        (EvaluationOptions(horizons=(float("inf"),)), "horizons must be positive seconds"),
    ]:
        with subtests.test(options=options, message=message), pytest.raises(SettingsError, match=message):
            evaluate(log, options=options)


def test_horizon_without_windows_gives_a_note(log: Log) -> None:
    result = evaluate(log, options=EvaluationOptions(methods=("none",), horizons=(2.0, 100.0, 2.0)))
    assert result.horizons == (2.0,)
    assert "no prediction over 100 s: the log has 0 such windows" in result.notes
    with pytest.raises(KeyError):
        result.score("none", 100.0)


def test_no_horizon_with_windows_is_an_error_with_advice(log: Log) -> None:
    with pytest.raises(LogError, match=r"no two windows of any horizon .*shorter --horizons"):
        evaluate(log, options=EvaluationOptions(horizons=(100.0,)))


def test_model_of_another_drive_is_causal_and_of_the_same_log_is_not(log: Log) -> None:
    settings = make_settings({"basis": "edd-2"})
    model = calibrate(log, input="wheel", settings=settings).model
    options = EvaluationOptions(methods=("none", "model"), horizons=(2.0,), model=model)
    other = replace(simulated_log(replace(DRIVE, seed=9)), sources=(Source("b.csv", "cd" * 32, "csv", 1200),))
    fresh, seen = (evaluate(x, options=options).score("model", 2.0) for x in (other, log))
    assert (fresh.causal, seen.causal) == (True, False)
    assert fresh.position_ratio[0] < 0.2


def test_a_model_of_inputs_that_were_scaled_otherwise_is_said(log: Log) -> None:
    read_so = scaled_inputs(log, LogOptions(wheel_scale=(0.5, 1.0)))
    model = calibrate(read_so, input="wheel", settings=make_settings({"basis": "edd-2"})).model
    options = EvaluationOptions(methods=("none", "model"), horizons=(2.0,), model=model)
    plain, same = (evaluate(each, options=options).notes for each in (log, read_so))
    said = "model has learned inputs times 0.5 and 1, and those of this log are times 1 and 1"
    assert any(each.startswith(said) for each in plain)
    assert not any(each.startswith(said) for each in same)


def test_model_of_another_ground_is_judged_by_the_ellipsoids_that_its_file_states(log: Log) -> None:
    """Tails learned from the errors of a robot that turns 70 % made a model of 60 % look true."""
    model = calibrate(log, input="wheel", settings=make_settings({"basis": "edd-2"})).model
    options = EvaluationOptions(methods=("none", "model"), horizons=(2.0,), model=model)
    same, other = (
        evaluate(simulated_log(replace(DRIVE, seed=9, alpha=alpha)), options=options).score("model", 2.0)
        for alpha in ((-0.1, -0.4), (-0.1, -0.3))
    )
    assert same.coverage[2] > 0.85
    assert other.coverage[2] < 0.5
    assert other.nis > 30.0


def test_model_decides_the_input_and_another_one_is_refused(log: Log) -> None:
    model = calibrate(log, input="wheel", settings=make_settings({"basis": "edd-2"})).model
    options = EvaluationOptions(methods=("model",), model=model)
    assert evaluate(log, options=options).input == "wheel"
    with pytest.raises(SettingsError, match=r"learned from wheel input, not command .*use --input wheel"):
        evaluate(log, input="command", options=options)


def test_runs_without_poses_or_inputs_are_passed_over() -> None:
    good = simulated_run(replace(DRIVE, name="good"))
    no_poses = replace(good, name="none", poses=empty_poses())
    no_wheels = replace(good, name="none", wheels=None)
    result = evaluate(
        Log(runs=(no_poses, no_wheels, good)),
        input="wheel",
        options=EvaluationOptions(methods=("none",)),
    )
    alone = evaluate(Log(runs=(good,)), input="wheel", options=EvaluationOptions(methods=("none",)))
    assert {int(r) for p in result.predictions for r in p.run} == {2}
    for one, other in zip(result.scores, alone.scores, strict=True):
        assert (one.windows, one.position, one.heading) == (other.windows, other.position, other.heading)


def test_wheels_that_start_late_are_used_where_they_are() -> None:
    run = simulated_run(Drive(seconds=40.0, lag=0.3))
    assert run.wheels is not None
    keep = run.wheels.t > 20.0
    log = Log(runs=(replace(run, wheels=run.wheels.select(keep)),))
    options = EvaluationOptions(methods=("auto",), horizons=(2.0,))
    (wheel,) = evaluate(log, input="wheel", options=options).predictions
    (command,) = evaluate(log, input="command", options=options).predictions
    assert wheel.t_start.min() > 20.0
    assert command.t_start.min() < 1.0


def test_perfect_drive_without_any_error_has_no_ratio() -> None:
    log = Log(runs=(steady_run(seconds=30.0, v=0.5, omega=0.0),))
    score = evaluate(log, options=EvaluationOptions(methods=("none",), horizons=(2.0,))).score("none", 2.0)
    assert score.position.mean == pytest.approx(0.0, abs=1e-12)
    assert isinstance(score, Score)


def test_percent_of_distance_is_that_of_the_path_driven_and_not_of_the_chord() -> None:
    """A robot on a circle that it closes every 5 s: the chord is nothing, the path 5 m."""
    run = steady_run(seconds=40.0, v=1.0, omega=2.0 * np.pi / 5.0)
    rng = np.random.default_rng(0)
    poses = replace(run.poses, x=run.poses.x + 0.05 * rng.standard_normal(len(run.poses)))
    options = EvaluationOptions(methods=("none",), horizons=(5.0,))
    score = evaluate(Log(runs=(replace(run, poses=poses),)), options=options).score("none", 5.0)
    assert score.percent_of_distance == pytest.approx(100.0 * score.position.mean / 5.0)


def test_second_half_is_scored_and_the_odd_window_belongs_to_it() -> None:
    assert [held_out_half(n) for n in (0, 1, 2, 7)] == [slice(0, 0), slice(0, 1), slice(1, 2), slice(3, 7)]


def test_what_a_calibration_predicted_is_what_would_be_predicted_again(
    log: Log, evaluation: Evaluation
) -> None:
    made = {"auto": calibrate(log, input="wheel").predictions}
    found = evaluate(log, input="wheel", options=EvaluationOptions(methods=("auto",), made=made))
    again = [p for p in evaluation.predictions if p.method == "auto"]
    assert [p.horizon for p in found.predictions] == [p.horizon for p in again]
    for one, other in zip(found.predictions, again, strict=True):
        for name, value in vars(other).items():
            np.testing.assert_array_equal(getattr(one, name), value, err_msg=name)
    assert found.score("auto", 2.0).position == evaluation.score("auto", 2.0).position
    elsewhere = EvaluationOptions(horizons=(3.0,), methods=("auto",), made=made)
    assert evaluate(log, input="wheel", options=elsewhere).horizons == (3.0,)

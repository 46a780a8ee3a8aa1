# SPDX-License-Identifier: Apache-2.0
"""Nothing measured after a prediction's start reaches it: logs are cut off or spoilt, and nothing changes."""

from __future__ import annotations

import gzip
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, log_until, moved, simulated_log, simulated_run

from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.calibration.predictions import Predictions
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Inputs, Log, Poses, open_log

METHODS = ("none", "edd-2", "auto", "surface-least-squares", "surface-bayesian")
OPTIONS = EvaluationOptions(methods=METHODS)
REAL = "warthog/grass_7_29_14h46s15.csv.gz"
SLIP = _core.named_basis("full-linear-6")


@cache
def simulated() -> Log:
    drive = Drive(seconds=60.0, basis=SLIP, alpha=(-0.1, 0.02, 0.03, 0.05, 0.02, -0.3), lag=0.2, delay=0.15)
    first = simulated_run(replace(drive, late=0.1, name="first"))
    second = simulated_run(replace(drive, seed=2, late=0.1, seconds=40.0, name="second"))
    return Log(runs=(first, moved(second, 62.0)))


@cache
def real(folder: Path) -> Log:
    return open_log(folder / REAL)


@pytest.fixture(params=["simulated", "real"])
def log(request: pytest.FixtureRequest) -> Log:
    """A simulated log of two runs on one clock, and a real one."""
    if request.param == "simulated":
        return simulated()
    return real(request.getfixturevalue("real_log_dir"))


def spoilt_poses(poses: Poses, after: float) -> Poses:
    """Move and turn the poses after `after` [s] as far as passes for a measurement; stamps stay."""
    late = poses.t > after
    return replace(
        poses,
        x=poses.x + 0.3 * late,
        y=poses.y - 0.2 * late * np.sin(np.arange(len(poses))),
        yaw=poses.yaw + 0.4 * late,
    )


def spoilt_inputs(inputs: Inputs, after: float) -> Inputs:
    late = inputs.t > after
    return replace(inputs, v=inputs.v + 3.0 * late, omega=inputs.omega - 2.0 * late)


def chosen(predictions: Predictions) -> list[int]:
    """The middle and the last prediction."""
    return sorted({round(fraction * (len(predictions) - 1)) for fraction in (0.5, 1.0)})


def same(one: Predictions, i: int, other: Predictions, j: int) -> None:
    """Both hold the same prediction, to the last bit."""
    for name in ("t_start", "t_end", "pose", "covariance", "inflation", "dof", "learned_until"):
        a, b = np.asarray(getattr(one, name)[i]), np.asarray(getattr(other, name)[j])
        assert a.tobytes() == b.tobytes(), (one.method, name, float(one.t_start[i]))


def by_name(evaluation: Evaluation) -> dict[tuple[str, float], Predictions]:
    return {(p.method, p.horizon): p for p in evaluation.predictions}


def evaluated(log: Log, input_name: str, *, learn: bool = True) -> dict[tuple[str, float], Predictions]:
    """Return predictions of two seconds, where the slip disturbance is learned or not."""
    options, settings = (
        replace(OPTIONS, horizons=(2.0,)),
        make_settings({"slip_disturbance": {"learn": learn}}),
    )
    return by_name(evaluate(log, input=input_name, options=options, settings=settings))


whole_of = cache(evaluated)  # several tests hold others against them


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_log_cut_off_anywhere_gives_the_same_predictions(log: Log, input_name: str) -> None:
    whole = evaluate(log, input=input_name, options=OPTIONS)
    first, last = whole.predictions[0].t_start[0], whole.predictions[0].t_end[-1]
    for fraction in (0.4, 0.8):
        until = float(first + fraction * (last - first))
        part = evaluate(log_until(log, until), input=input_name, options=OPTIONS)
        for key, here in by_name(part).items():
            there = by_name(whole)[key]
            places = {(t, e): i for i, (t, e) in enumerate(zip(there.t_start, there.t_end, strict=True))}
            found = [
                (places.get((t, e)), j) for j, (t, e) in enumerate(zip(here.t_start, here.t_end, strict=True))
            ]
            pairs = [(i, j) for i, j in found if i is not None]
            # The last pose before the cut may stand in for a nearer one behind it.
            assert len(pairs) >= max(1, len(here) - 1)
            for i, j in pairs:
                same(there, i, here, j)


@pytest.mark.slow
@pytest.mark.parametrize("input_name", ["wheel", "command"])
@pytest.mark.parametrize("at_start", [False, True])
def test_parameters_use_no_pose_within_the_embargo_and_nothing_uses_one_after_the_start(
    log: Log, input_name: str, *, at_start: bool
) -> None:
    whole = whole_of(log, input_name, learn=at_start)
    for i in chosen(whole["auto", 2.0]):
        start = float(whole["auto", 2.0].t_start[i])
        until = start if at_start else start - 2.0  # the slip and the pose now are of the start
        runs = tuple(replace(run, poses=spoilt_poses(run.poses, until + 1e-6)) for run in log.runs)
        spoilt = evaluated(replace(log, runs=runs), input_name, learn=at_start)
        for key, predictions in whole.items():
            same(predictions, i, spoilt[key], i)
        assert not np.array_equal(whole["auto", 2.0].measured[i], spoilt["auto", 2.0].measured[i])


@pytest.mark.slow
def test_predictions_from_commands_use_no_wheel_speed_after_their_start(log: Log) -> None:
    whole = whole_of(log, "command", learn=True)
    for i in chosen(whole["auto", 2.0]):
        start = float(whole["auto", 2.0].t_start[i])
        runs = tuple(
            replace(run, wheels=None if run.wheels is None else spoilt_inputs(run.wheels, start))
            for run in log.runs
        )
        spoilt = evaluated(replace(log, runs=runs), "command")
        for key, predictions in whole.items():
            same(predictions, i, spoilt[key], i)


@pytest.mark.slow
@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_predictions_use_no_input_after_their_end(log: Log, input_name: str) -> None:
    whole = whole_of(log, input_name, learn=True)
    for i in chosen(whole["auto", 2.0]):
        end = float(whole["auto", 2.0].t_end[i])
        runs = tuple(
            replace(
                run,
                commands=None if run.commands is None else spoilt_inputs(run.commands, end),
                wheels=None if run.wheels is None else spoilt_inputs(run.wheels, end),
            )
            for run in log.runs
        )
        spoilt = evaluated(replace(log, runs=runs), input_name)
        for key, predictions in whole.items():
            same(predictions, i, spoilt[key], i)


@pytest.mark.slow
@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_stated_times_lie_before_the_start_and_those_of_parameters_before_the_embargo(
    log: Log, input_name: str
) -> None:
    still = make_settings({"slip_disturbance": {"learn": False}})
    for settings in (still, make_settings({})):
        for p in evaluate(log, input=input_name, options=OPTIONS, settings=settings).predictions:
            assert (p.learned_until <= p.t_start + 1e-9).all()
            if input_name == "command" and p.method != "none":
                assert (p.learned_until == p.t_start).all()  # the wheel speed at the start is used
            elif settings is still or p.method == "none":
                begin = np.array([log.runs[r].poses.t[0] for r in p.run])
                assert (p.learned_until <= np.maximum(begin, p.t_start - p.horizon) + 1e-6).all()


def test_file_cut_off_gives_the_same_predictions_as_the_whole_file(
    real_log_dir: Path, tmp_path: Path
) -> None:
    with gzip.open(real_log_dir / REAL, "rt", encoding="utf-8") as file:
        lines = file.read().splitlines(keepends=True)
    part = tmp_path / "part.csv"
    part.write_text("".join(lines[: len(lines) * 3 // 5]), encoding="utf-8")
    whole, cut = (evaluate(open_log(path), options=OPTIONS) for path in (real_log_dir / REAL, part))
    for key, here in by_name(cut).items():
        for i in range(len(here) - 1):
            same(by_name(whole)[key], i, here, i)


@pytest.mark.parametrize("embargo", [0.0, 10.0])
def test_embargo_is_the_one_that_is_asked_for(embargo: float) -> None:
    settings = make_settings({"slip_disturbance": {"learn": False}})
    options = replace(OPTIONS, horizons=(5.0,), embargo=embargo)
    result = evaluate(simulated(), input="wheel", options=options, settings=settings)
    assert result.embargo == embargo
    for p in result.predictions:
        begin = np.array([simulated().runs[run].poses.t[0] for run in p.run])
        assert (p.learned_until <= np.maximum(begin, p.t_start - embargo) + 1e-6).all()
        if p.method != "none":
            assert (p.t_start - p.learned_until < embargo + 3.5).sum() > 0.5 * len(p)
    options = replace(options, embargo=None)
    usual = by_name(evaluate(simulated(), input="wheel", options=options, settings=settings))
    assert not np.array_equal(by_name(result)["auto", 5.0].pose, usual["auto", 5.0].pose)


def test_embargo_holds_across_runs_that_follow_each_other_on_one_clock() -> None:
    log = simulated()
    options = EvaluationOptions(methods=("auto",), horizons=(5.0,))
    (whole,) = evaluate(log, input="wheel", options=options).predictions
    first = int(np.flatnonzero(whole.run == 1)[0])
    embargo = float(whole.t_start[first]) - 5.0
    assert embargo < log.runs[0].poses.t[-1] - 2.0
    poses = spoilt_poses(log.runs[0].poses, embargo + 1e-6)
    runs = (replace(log.runs[0], poses=poses), log.runs[1])
    (spoilt,) = evaluate(replace(log, runs=runs), input="wheel", options=options).predictions
    same(whole, first, spoilt, first)


def test_runs_with_clocks_of_their_own_learn_from_all_earlier_runs() -> None:
    log = simulated()
    own_clock = Log(runs=(log.runs[0], moved(log.runs[1], -62.0)))
    settings = make_settings({"basis": "edd-2"})
    options = EvaluationOptions(methods=("none", "edd-2"), horizons=(2.0,))
    result = evaluate(own_clock, input="wheel", settings=settings, options=options)
    plain, learned = result.predictions
    second = plain.run == 1
    at_once = second & (plain.t_start < 1.0)
    assert at_once.any()
    assert learned.heading_error[second].mean() < 0.5 * plain.heading_error[second].mean()
    assert not np.array_equal(learned.pose[at_once], plain.pose[at_once])


def test_method_that_saw_its_windows_is_not_called_causal() -> None:
    result = evaluate(simulated_log(Drive(seconds=40.0)), options=replace(OPTIONS, methods=("none", "batch")))
    assert [score.causal for score in result.scores] == [score.method == "none" for score in result.scores]
    batch = next(p for p in result.predictions if p.method == "batch")
    assert (batch.learned_until >= batch.t_end).all()


def test_windows_never_overlap(log: Log) -> None:
    for p in evaluate(log, input="wheel", options=replace(OPTIONS, methods=("none",))).predictions:
        for run in np.unique(p.run):
            start, end = p.t_start[p.run == run], p.t_end[p.run == run]
            assert all(e <= s for (_, e), (s, _) in pairwise(zip(start, end, strict=True)))

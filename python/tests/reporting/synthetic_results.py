# SPDX-License-Identifier: Apache-2.0
"""A small drive with known slip, its model and its scores, put together without learning anything."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise import _core
from slipwise.calibration.result import Calibration, History, Verdict
from slipwise.evaluation.result import ErrorSummary, Evaluation, Predictions, Score
from slipwise.logs.log import Inputs, LeftOut, Log, Poses, Run, Source
from slipwise.models.model import Model
from slipwise.models.schema import ModelFile

SEED = 7
DURATION, RATE, HORIZON = 120.0, 10.0, 5.0
TRUTH = np.array([-0.05, -0.35])  # edd-2: fraction of speed and of yaw rate that slip takes away
METHODS = ("none", "vendor", "edd-2", "odd-even-10", "batch", "auto")
SHARE_KNOWN = {"none": 0.0, "vendor": 0.6, "edd-2": 0.95, "odd-even-10": 0.97, "batch": 1.0, "auto": 0.98}
BASES = ("none", "edd-2", "drive-5")


@dataclass(frozen=True)
class Results:
    """What `write_report` is given."""

    log: Log
    calibration: Calibration
    evaluation: Evaluation


def make_results(*, runs: int = 1, run_name: str = "field") -> Results:
    """Return a log of `runs` drives with everything that a report shows."""
    log = Log(
        runs=tuple(_run(place, f"{run_name} {place}") for place in range(runs)),
        sources=(Source("/data/field.mcap", "ab" * 32, "mcap", 2400),),
        left_out=(LeftOut("the stamp stands twice", 3, "row 17", "duplicate-stamp"),),
        notes=("the pose topic /odom was guessed",),
    )
    return Results(log, _calibration(runs), _evaluation(log))


def without_history(results: Results) -> Results:
    """Return the results as of a batch fit."""
    return replace(results, calibration=replace(results.calibration, history=None))


def with_verdict(results: Results, verdict: Verdict) -> Results:
    """Return the results with another verdict."""
    return replace(results, calibration=replace(results.calibration, verdict=verdict))


def with_model(results: Results, **changes: object) -> Results:
    """Return the results with other content of the model file."""
    content = results.calibration.model.content.model_copy(update=changes)
    return replace(results, calibration=replace(results.calibration, model=Model(content)))


def _model() -> _core.MotionModel:
    return _core.MotionModel(_core.named_basis("edd-2"), False, False)


def _run(place: int, name: str) -> Run:
    rng = np.random.default_rng(SEED + place)
    t = np.arange(0.0, DURATION, 0.1)
    v = 1.0 + 0.8 * np.sin(0.11 * t)
    omega = 0.7 * np.sin(0.23 * t + place) * np.cos(0.05 * t)
    commands = Inputs(t=t, v=v, vy=np.zeros_like(t), omega=omega)
    history = _core.InputHistory(t, v, np.zeros_like(t), omega)
    segment = _core.Segment(0.0, DURATION, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(_model(), TRUTH, history, segment, _core.Integrator.Exact)
    stamps = np.arange(0.0, DURATION, 1.0 / RATE)
    x, y, yaw = (np.interp(stamps, path.times, path.poses[:, k]) for k in range(3))
    noise = rng.normal(size=(2, len(stamps))) * 0.01
    wrapped = np.angle(np.exp(1j * yaw))
    poses = Poses(
        t=stamps, x=x + noise[0], y=y + noise[1], yaw=wrapped, frame=np.zeros(len(stamps), np.int64)
    )
    return Run(name=name, commands=commands, wheels=None, poses=poses)


def _calibration(runs: int) -> Calibration:
    content = ModelFile.model_validate(
        {
            "slipwise_model": 5,
            "input": "command",
            "slip": {"basis": "edd-2", "lon": ["V"], "lat": [], "ang": ["w"]},
            "dynamics": False,
            "clock_offset": False,
            "parameters": [
                {
                    "name": "lon.V",
                    "stage": "slip",
                    "unit": "m/s per V",
                    "value": -0.049,
                    "std": 0.004,
                    "prior_std": 0.3,
                    "identifiable": True,
                },
                {
                    "name": "ang.w",
                    "stage": "slip",
                    "unit": "rad/s per w",
                    "value": -0.348,
                    "std": 0.01,
                    "prior_std": 0.3,
                    "identifiable": True,
                },
            ],
            "covariance": [[1.6e-5, 0.0], [0.0, 1e-4]],
            "noise": {
                "psd_time": [1e-4, 1e-4, 1e-4],
                "psd_motion": [1e-3, 1e-3, 1e-3],
                "fraction": [0.01, 0.01, 0.01],
                "pose_std_xy": 0.01,
                "pose_std_yaw": 0.005,
                "variance_scale": [1.0, 1.0, 1.0],
            },
            "range": {"speed": [0.2, 1.8], "yaw_rate": [-0.7, 0.7], "slope": 0.0},
            "provenance": {
                "slipwise_version": "0.0.test",
                "logs": [{"path": "/data/field.mcap", "sha256": "ab" * 32}],
                "settings": {"basis": "auto"},
                "learned_seconds": DURATION * runs,
                "learned_segments": 48 * runs,
            },
            "verdict": {"good": True, "sentence": "Good."},
        }
    )
    verdict = Verdict(good=True, sentence="The learned model misses by 0.1 m after 5 s.")
    return Calibration(Model(content), verdict, _history(runs), left_out=(), notes=())


def _history(runs: int) -> History:
    t = np.arange(2.5, DURATION, 2.5)
    run = np.repeat(np.arange(runs), len(t))
    known = 1.0 - np.exp(-np.arange(1, len(run) + 1) / 5.0)
    alarm = np.isin(np.arange(len(run)), (20, 21))
    weight = np.column_stack((1.0 - known, 0.7 * known, 0.3 * known))
    return History(
        run=run,
        t=np.tile(t, runs),
        names=("lon.V", "ang.w"),
        mean=known[:, None] * TRUTH,
        std=0.3 * (1.0 - 0.98 * known)[:, None] * np.ones(2),
        nis=np.random.default_rng(SEED).chisquare(3.0, len(run)),
        weight=np.ones(len(run)),
        bases=BASES,
        basis_weight=weight,
        change=np.where(alarm, 12.0, 0.0),
        alarm=alarm,
    )


def _evaluation(log: Log) -> Evaluation:
    predictions = tuple(
        _predictions(log, method, horizon) for method in METHODS for horizon in (2.0, HORIZON)
    )
    return Evaluation(
        input="command",
        horizons=(2.0, HORIZON),
        methods=METHODS,
        scores=tuple(_score(part, predictions) for part in predictions),
        predictions=predictions,
        runs=tuple(run.name for run in log.runs),
        left_out=(LeftOut("the input is unknown", 2, "t = 3.0 s", "unknown-input"),),
        notes=(),
    )


def _predictions(log: Log, method: str, horizon: float) -> Predictions:
    starts = np.arange(0.0, DURATION - horizon - 0.2, horizon)
    rows, poses, covariances = [], [], []
    for place, run in enumerate(log.runs):
        assert run.commands is not None
        inputs = run.commands
        history = _core.InputHistory(inputs.t, inputs.v, inputs.vy, inputs.omega)
        for start in starts.tolist():
            segment = _core.Segment(start, start + horizon, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
            known = TRUTH * SHARE_KNOWN[method]
            path = _core.integrate_segment(_model(), known, history, segment, _core.Integrator.Exact)
            rows.append((place, start))
            poses.append(path.poses[-1])
            covariances.append(np.diag([0.01, 0.02, 0.004]) * horizon)
    run_index, t_start = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    measured = np.array([_measured(log.runs[place].poses, start, start + horizon) for place, start in rows])
    return Predictions(
        method=method,
        horizon=horizon,
        run=run_index,
        t_start=t_start,
        t_end=t_start + horizon,
        pose=np.array(poses),
        covariance=np.array(covariances),
        inflation=np.ones(len(rows)),
        dof=np.full(len(rows), 5.0),
        nominal_nis=np.full(len(rows), 3.0),
        measured=measured,
        learned_until=t_start,
        structure=np.zeros(len(rows), np.int64),
        in_sample=np.full((len(rows), 2), 0.01),
    )


def _measured(poses: Poses, start: float, end: float) -> np.ndarray:
    i, j = (int(np.argmin(np.abs(poses.t - at))) for at in (start, end))
    a, b = (_core.Pose2(float(poses.x[k]), float(poses.y[k]), float(poses.yaw[k])) for k in (i, j))
    return np.asarray(_core.between(a, b).vector())


def _score(part: Predictions, group: tuple[Predictions, ...]) -> Score:
    plain = next(p for p in group if p.method == "none" and p.horizon == part.horizon)
    position = float(part.position_error.mean() / plain.position_error.mean())
    heading = float(part.heading_error.mean() / plain.heading_error.mean())
    return Score(
        method=part.method,
        causal=part.method != "batch",
        horizon=part.horizon,
        windows=len(part),
        position=_summary(part.position_error),
        heading=_summary(part.heading_error),
        percent_of_distance=2.0,
        position_ratio=(position, 0.9 * position, 1.1 * position),
        heading_ratio=(heading, 0.9 * heading, 1.1 * heading),
        position_to_rival=0.9,
        heading_to_rival=0.8,
        in_sample_position=0.0123,
        in_sample_heading=0.01,
        nis=float(part.nis.mean()),
        nis_band=(2.2, 3.9),
        coverage=(0.48, 0.91, 0.96),
        reported_nis=float(part.nis.mean()),
        reported_coverage=(0.6, 0.8, 0.85),
    )


def _summary(errors: np.ndarray) -> ErrorSummary:
    mean = float(errors.mean())
    return ErrorSummary(mean, 0.8 * mean, 1.2 * mean, float(np.median(errors)), mean, float(errors.max()))

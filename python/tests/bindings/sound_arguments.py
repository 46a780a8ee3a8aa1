# SPDX-License-Identifier: Apache-2.0
"""Arguments with which every function of the compiled core works; a new binding may need a line here."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from bindings.sound_dynamics import DYNAMICS_ARGUMENTS, DYNAMICS_OBJECTS
from bindings.sound_surfaces import SURFACE_ARGUMENTS, SURFACE_OBJECTS, remembering_learner
from bindings.sound_terrain import TERRAIN_ARGUMENTS, TERRAIN_OBJECTS
from bindings.sound_vehicles import VEHICLE_ARGUMENTS, VEHICLE_OBJECTS
from bindings.stub_calls import Bound, bound_functions, compiled

from slipwise import _core
from slipwise_thesis import _thesis

SIZE = 3  # parameters of the model below: two of slip, and the clock offset
ROWS = 60
T = np.arange(ROWS) * 0.1


def _model() -> _core.MotionModel:
    return _core.MotionModel(_core.named_basis("edd-2"), False, True)


def _inputs() -> _core.InputHistory:
    return _core.InputHistory(T, np.sin(T), np.zeros(ROWS), np.cos(T))


def _segment() -> _core.Segment:
    return _core.Segment(1.0, 2.0, _core.Pose2(0.5, 0.1, 0.2), _core.BodyTwist(0.5, 0.0, 0.1), 0.0, 0.0)


def _elevations() -> _core.ElevationMap:
    return _core.ElevationMap(np.arange(12.0).reshape(3, 4) * 0.05, np.zeros(2), 1.0)


def _estimate() -> _core.Estimate:
    return _core.Estimate(np.full(SIZE, 0.01), 0.01 * np.eye(SIZE))


def _law() -> _core.DisturbanceModel:
    return _core.DisturbanceModel([_core.SlipDisturbance(0.1, 0.1, 5.0)], np.ones(1))


def _noise() -> _core.MotionNoise:
    return _core.MotionNoise([1e-4] * 3, [1e-4] * 3, [0.01] * 3, 0.01, 0.01)


def _posterior() -> _core.MotionPosterior:
    return _core.MotionPosterior(_model(), _estimate(), np.ones(SIZE), _noise(), np.ones(3))


def _now() -> _core.SlipNow:
    return _core.DisturbanceFilter(_law()).now(_posterior(), _inputs(), [_segment()])


def _expected() -> _core.ExpectedPose:
    return _core.DisturbanceFilter(_law()).predict(_posterior(), _inputs(), _now(), _segment())


def _steady() -> _thesis.SteadySegment:
    times = np.array([0.0, 1.0, 2.0])
    rng = np.random.default_rng(1)
    return _thesis.SteadySegment(_core.BodyTwist(1.0, 0.0, 0.2), times, rng.normal(size=(3, 3)) * 0.1)


def _noise_group() -> _thesis.NoiseGroup:
    rng = np.random.default_rng(2)
    return _thesis.NoiseGroup(
        _core.BodyTwist(1.0, 0.0, 0.2), [1.0, 2.0], list(rng.normal(size=(9, 3, 2)) * 0.1)
    )


def _fit() -> _thesis.LeastSquaresFit:
    return _thesis.fit_least_squares(_features(), T, np.ones(ROWS))


def _features() -> np.ndarray:
    return np.column_stack([np.ones(ROWS), np.sin(T)])


def _regression() -> _thesis.BayesianRegression:
    regression = _thesis.BayesianRegression(np.ones(2), 0.1, 1.0)
    regression.add(_example())
    return regression


def _example() -> _thesis.RegressionExample:
    return _thesis.RegressionExample(np.array([1.0, 0.5]), 0.3, 1.0)


def _limits() -> _core.CommandLimits:
    axis = _core.AxisLimits(0.01, 2.0, 1.0, 1.5)
    return _core.CommandLimits(axis, axis, axis, 0.5, 1.0, 1.0)


def _record() -> _core.WheelRecord:
    wheels = np.column_stack([T, np.sin(T - 0.2), np.cos(T - 0.2)])
    return _core.WheelRecord(_inputs(), wheels)


def _mppi() -> _core.Mppi:
    settings = _core.MppiSettings()
    settings.rollouts, settings.periods = 16, 8
    return _core.Mppi([(_model(), np.full(SIZE, 0.01), None, (0.0, 0.0), None, False)], settings, None)


def _drive_start() -> _core.ActuatorState:
    return _core.ActuatorState(_core.BodyTwist(0.1, 0.0, 0.0), _core.BodyTwist(0.1, 0.0, 0.0), None)


def _planner() -> _core.TrajectoryPlanner:
    limits = _core.DriveLimits(1.0, 1.0, 1.0, 1.0)
    return _core.TrajectoryPlanner(
        _model(), np.full(SIZE, 0.01), limits, _core.TrajectorySettings(), _drive_start(), None
    )


def _uncertain() -> _core.UncertainModel:
    model, spread = _model(), (0.01 * np.eye(SIZE), _noise(), np.ones(3), 1.0, _law(), np.ones(SIZE))
    return _core.UncertainModel(model, np.full(SIZE, 0.01), *spread, 0.1, [0.0] * 4, None, None, False)


def _following() -> _thesis.FollowingEstimator:
    return _thesis.FollowingEstimator(
        "iekf", _model(), _core.CausalFilterSettings(), _thesis.EstimatorSettings()
    )


def _average() -> _core.ModelAverage:
    settings = (_core.CausalFilterSettings(), _core.ModelAverageSettings())
    return _core.ModelAverage("auto", [_core.named_basis("edd-2")], True, False, False, *settings)


def _learner_settings() -> _core.LearnerSettings:
    settings, hypotheses = _core.LearnerSettings(), _core.HypothesisSettings()
    hypotheses.bases = [_core.named_basis("edd-2")]
    settings.hypotheses = hypotheses
    return settings


def _learner() -> _core.MotionLearner:
    learner = _core.MotionLearner(_learner_settings())
    learner.push(_recording())
    return learner


def _recent_evidence() -> _core.RecentEvidence | None:
    """Of a drive that is longer than what is recent."""
    t = np.arange(0.0, 200.0, 0.5)
    zero = np.zeros_like(t)
    driven = np.column_stack((t, zero + 0.5, zero, zero))
    poses = np.column_stack((t, 0.5 * t, zero, zero, zero))
    run = _core.Recording(driven, np.empty((0, 4)), np.empty((0, 3)), poses)
    return _core.motion_evidence(_core.StreamSettings(), [run]).recent


def _recording() -> _core.Recording:
    return _core.Recording(
        _rows(), _rows(), np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), np.column_stack((_rows(), T * 0))
    )


def _rows() -> np.ndarray:
    return np.column_stack((T, np.sin(T), np.zeros(ROWS), np.cos(T)))


def _chain_learner() -> _core.ActuatorFilter:
    return _core.ActuatorFilter(_core.CausalFilterSettings())


def _slip_ratios() -> _thesis.SlipRatioFilterSettings:
    settings = _thesis.SlipRatioFilterSettings()
    settings.noise = _noise()
    return settings


def _estimator_settings() -> _thesis.EstimatorSettings:
    settings = _thesis.EstimatorSettings()
    settings.noise = _noise()
    return settings


def _small_mppi() -> _core.MppiSettings:
    settings = _core.MppiSettings()
    settings.rollouts, settings.periods = 16, 8
    return settings


OBJECTS: dict[str, Callable[[], Any]] = {
    **SURFACE_OBJECTS,
    **TERRAIN_OBJECTS,
    **VEHICLE_OBJECTS,
    **DYNAMICS_OBJECTS,
    "AverageState": lambda: _average().state(),
    "BayesianRegression": _regression,
    "Basis": lambda: _core.named_basis("edd-2"),
    "ActuatorFilter": _chain_learner,
    "MotionEvidence": lambda: _core.motion_evidence(_core.StreamSettings(), []),
    "RecentEvidence": _recent_evidence,
    "ForceFrame": lambda: _core.ForceFrame.Body,
    "DisturbanceFilter": lambda: _core.DisturbanceFilter(_law()),
    "CommandLimits": _limits,
    "CostmapView": lambda: _core.CostmapView(np.zeros((4, 5), np.float32), 0.5, 0.0, 0.0, 100.0),
    "DriveLimits": lambda: _core.DriveLimits(1.0, 1.0, 1.0, 1.0),
    "WheelRecord": _record,
    "ActuatorState": _drive_start,
    "Estimate": _estimate,
    "Estimator": lambda: _thesis.make_estimator("iekf", _model(), _estimate(), _estimator_settings()),
    "ExpectedPose": _expected,
    "FollowingEstimator": _following,
    "Gpu": lambda: None,
    "HeldOutPredictions": lambda: _learner().model().held_out[0],
    "InputHistory": _inputs,
    "Integrator": lambda: _core.Integrator.Exact,
    "LeastSquaresFit": _fit,
    "LearnedModel": lambda: _learner().model(),
    "LearnerEvent": lambda: _learner().events()[0],
    "LearnerSettings": _learner_settings,
    **dict.fromkeys(("ActuatorLimits", "LimitSearch"), lambda: None),
    "ElevationMap": _elevations,
    "Ground": lambda: _core.Ground.mapped(_elevations(), _core.Pose2(0.5, 0.5, 0.3)),
    "LogVarianceFit": lambda: _thesis.fit_log_variance(np.column_stack([T, np.sin(T)]), _fit()),
    "MotionPosterior": _posterior,
    "MotionLearner": _learner,
    "MotionModel": _model,
    "MotionNoise": _noise,
    "Mppi": _mppi,
    "MppiSettings": _small_mppi,
    "NoiseGroup": _noise_group,
    "Recording": _recording,
    "RegressionExample": _example,
    "RolloutProgram": lambda: _core.RolloutProgram(
        _model(), np.full(SIZE, 0.01), 0.1, [0.0] * 4, None, None, False
    ),
    "ScatterCentre": lambda: _thesis.ScatterCentre.Mean,
    "Segment": _segment,
    "SegmentJacobian": lambda: _thesis.SegmentJacobian.Thesis,
    "SegmentLinearization": lambda: _core.linearize_segment(_model(), np.zeros(SIZE), _inputs(), _segment()),
    "SegmentPath": lambda: _core.linearize_segment(_model(), np.zeros(SIZE), _inputs(), _segment()).path,
    "SlipNow": _now,
    "SlipRatioFilterSettings": _slip_ratios,
    "StartList": lambda: _core.StartList(np.zeros((1, 6)), np.zeros((1, 1, 3))),
    "Status": lambda: _core.Status.Converged,
    "SteadyNoise": lambda: _thesis.SteadyNoise(np.full(3, 0.01), np.full(3, 0.01), np.full(3, 0.01)),
    "SteadySegment": _steady,
    "TrajectoryPlanner": _planner,
    "TrajectoryStatus": lambda: _core.TrajectoryStatus.Reached,
    "UncertainModel": _uncertain,
    "DisturbanceModel": _law,
    "DisturbedTerms": lambda: _core.disturbed_terms(_model(), np.ones(SIZE)),
}

_square, _list3 = 0.01 * np.eye(SIZE), [0.01, 0.01, 0.01]
ARGUMENTS: dict[str, Callable[[], Any]] = {
    **SURFACE_ARGUMENTS,
    **TERRAIN_ARGUMENTS,
    **VEHICLE_ARGUMENTS,
    **DYNAMICS_ARGUMENTS,
    "Recording.__init__ readings": lambda: {"gyro_z": np.zeros((3, 2))},
    "MotionLearner.push_reading column": lambda: "gyro_z",
    "CostmapView.__init__ cells": lambda: np.zeros((4, 5), np.float32),
    "HeldOutColumns.__init__ predictions": list,
    "WheelRecord.__init__ wheels": lambda: np.column_stack([T, np.sin(T), np.cos(T)]),
    "MotionLearner.forget fraction": lambda: 0.5,
    "MotionLearner.load saved": lambda: _learner().save(),
    "LearnedModel.predicted_again horizon": lambda: 0,
    "MotionLearner.predict future": lambda: np.array([[6.0, 0.5, 0.0, 0.1]]),
    "MotionLearner.predict forces": lambda: np.array([[6.0, 0.0, 0.5]]),
    "MotionLearner.predict limits": lambda: None,
    "Mppi.__init__ models": lambda: [(_model(), np.full(SIZE, 0.01), None, (0.0, 0.0), None, False)],
    "Mppi.adopt models": lambda: [(_model(), np.full(SIZE, 0.01), None, (0.0, 0.0), None, False)],
    "Mppi.step past": lambda: np.zeros((2, 3)),
    "Mppi.step reference": lambda: np.zeros((8, 3)),
    "NoiseGroup.__init__ residuals": lambda: list(np.ones((9, 3, 2))),
    "NoiseGroup.__init__ times": lambda: [1.0, 2.0],
    "Mppi.step drive": lambda: np.array([0.1, 0.0, 0.1]),
    "StartList.__init__ past": lambda: np.zeros((1, 1, 3)),
    "StartList.__init__ starts": lambda: np.zeros((1, 6)),
    "ElevationMap.__init__ cell": lambda: 0.5,
    "ElevationMap.__init__ elevation": lambda: np.zeros((3, 4)),
    "ElevationMap.__init__ origin": lambda: np.zeros(2),
    "Ground.measured rows": lambda: np.column_stack((T[:4], np.zeros((4, 2)))),
    "Ground.standings poses": lambda: np.zeros((2, 3)),
    "RolloutProgram.__init__ ground": lambda: [0.0, 0.0, 0.1, -0.2],
    "UncertainModel.__init__ ground": lambda: [0.1, -0.2, 0.0, 0.0],
    "Recording.__init__ attitudes": lambda: np.zeros((1, 3)),
    "Recording.__init__ commands": _rows,
    "Recording.__init__ poses": lambda: np.column_stack((_rows(), T * 0)),
    "Recording.__init__ wheels": _rows,
    "opened blob": lambda: _core.sealed(b"learned"),
    "sealed body": lambda: b"learned",
    "SteadySegment.__init__ poses": lambda: np.zeros((3, 3)),
    "SteadySegment.__init__ times": lambda: np.array([0.0, 1.0, 2.0]),
    "InputHistory.__init__ t": lambda: np.array([0.0, 0.1, 0.2]),
    "FollowingEstimator.__init__ name": lambda: "iekf",
    "DisturbanceModel.__init__ weights": lambda: np.ones(1),
    "learns_overlapping_segments name": lambda: "iekf",
    "slip_rate_covariance covariance": lambda: 0.01 * np.eye(2),
    "distance_field occupied": lambda: np.eye(6, dtype=np.uint8),
    "fit_least_squares design": _features,
    "fit_log_variance drive": lambda: np.column_stack([T, np.sin(T)]),
    "fit_slip_rates segments": lambda: [_steady(), _steady()],
    "iekf_update noise": lambda: 0.01 * np.eye(3),
    "make_estimator name": lambda: "iekf",
    "rollout_batch costs": lambda: None,
    "rollout_covariance growth": lambda: [1.0, 1.1, 1.2, 1.3],
    "rollout_covariance out": lambda: np.zeros((6, 4, 2)),
    "rts_smooth noise": lambda: [0.01 * np.eye(3)],
    "sample_futures out": lambda: np.zeros((3, 5, 4, 2)),
    "thesis_std_coefficients design": _features,
    "undetermined_directions terms": lambda: ["one", "sine"],
    "ActuatorFilter.learn end": lambda: 2.0,
    "ActuatorFilter.learn start": lambda: 1.0,
    "Segment.__init__ end": lambda: 2.0,
    "Basis.__init__ ang": lambda: ["w"],
    "Basis.__init__ lat": lambda: ["V*w"],
    "Basis.__init__ lon": lambda: ["V"],
}
NAMES: dict[str, Callable[[], Any]] = {
    "alpha": lambda: np.full(2, 0.01),
    "bases": lambda: [_core.named_basis("edd-2")],
    "commands": lambda: np.full((2, 4, 2), 0.3),
    "date": lambda: "2026-01-01",
    "end": lambda: None,
    "features": lambda: np.array([1.0, 0.5]),
    "filter": _core.CausalFilterSettings,
    "iekf": _core.IekfSettings,
    "label": lambda: "sand",
    "least": lambda: 0.9,
    "level": lambda: "portable",
    "learned": _square.copy,
    "limits": lambda: None,
    "log_scores": lambda: np.zeros(2),
    "map": lambda: None,
    "mean": lambda: np.full(SIZE, 0.01),
    "name": lambda: "edd-2",
    "of_drive": lambda: None,
    "output": T.copy,
    "parameters": lambda: np.full(SIZE, 0.01),
    "path": lambda: None,
    "prior": lambda: np.full(2, 0.5),
    "prior_std": lambda: np.ones(SIZE),
    "relative_std": lambda: np.ones(ROWS),
    "seed": lambda: 1,
    "slip": lambda: np.full(3, 0.01),
    "tangent": lambda: np.full(3, 0.1),
    "threads": lambda: 2,
    "times": lambda: np.array([0.5, 1.0]),
    "weight_std": lambda: np.ones(2),
    "weights": lambda: np.full(2, 0.5),
}


def sound(bound: Bound, parameter: str, annotation: str) -> Any:
    """Return a value of this parameter with which the function works."""
    if make := ARGUMENTS.get(f"{bound.title} {parameter}"):
        return make()
    if annotation.endswith(" | None") and "NDArray" not in annotation:
        return None
    if annotation in OBJECTS or compiled(annotation) is not None:
        return of_type(annotation)
    if inner := re.fullmatch(r"Sequence\[(\w+)\]", annotation):
        return _list3 if inner[1] == "float" else [of_type(inner[1])]
    if "NDArray" in annotation:
        return _array(bound, parameter, annotation)
    plain = {"float": 0.5, "int": 2, "bool": True, "tuple[float, float]": (0.1, 0.1)}
    return plain[annotation] if annotation in plain else NAMES[parameter]()


def owner_of(bound: Bound) -> Any:
    """Return an object on which the method works."""
    begins = bound.title == "MotionLearner.begin_with"  # before anything was learned
    return remembering_learner() if begins else of_type(bound.owner)


def of_type(name: str) -> Any:
    """Return a sound object of this type."""
    if name in OBJECTS:
        return OBJECTS[name]()
    makers = [b for b in bound_functions() if b.owner == name and b.name == "__init__"]
    return compiled(name)(*(sound(makers[0], *parameter) for parameter in makers[0].parameters))


def _array(bound: Bound, parameter: str, annotation: str) -> Any:
    shape = re.search(r"shape=\(?([^)]*?)\)?,? ?(?:order|device|writable|\))", annotation)
    sizes = [part.strip() for part in (shape[1] if shape else "None").split(",") if part.strip()]
    kind = "float32" if "float32" in annotation else "float64"
    if parameter in ("covariance", "parameters", "learned") and sizes == ["None", "None"]:
        return _square.copy()
    if sizes == ["None", "None"] and parameter == "features":
        return _features()
    if parameter in NAMES:
        value = NAMES[parameter]()
        return value if value is None else np.asarray(value, kind)
    return np.full([3 if size == "None" else int(size) for size in sizes], 0.1, kind)

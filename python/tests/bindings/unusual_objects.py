# SPDX-License-Identifier: Apache-2.0
"""Objects of the compiled core that are sound by themselves, of other sizes or times than the usual ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from bindings.sound_arguments import of_type

from slipwise import _core
from slipwise_thesis import _thesis


def other_objects(kind: str) -> Iterator[tuple[str, Any]]:
    """Yield objects of this type that are sound by themselves, of other sizes or times than those above."""
    nan, zero = float("nan"), np.zeros(1)
    larger = _core.MotionModel.with_response(_core.named_basis("odd-even-10"), True).with_extrinsics(True)
    path = _core.linearize_segment(larger, np.zeros(larger.size), of_type("InputHistory"), of_type("Segment"))
    wide = _core.Segment(1.0, 2.0, _core.Pose2(nan, 0.0, 0.0), None, nan, 0.0)
    late = _core.Segment(1e6, 1e6 + 1.0, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    backward = _core.Segment(2.0, 1.0, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    long = _core.Segment(-1e9, 1e9, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    others: dict[str, list[Any]] = {
        "Basis": [_core.named_basis("odd-even-10"), _core.Basis("none", [], [], [])],
        "BayesianRegression": [_thesis.BayesianRegression(np.ones(5), 0.1, 1.0)],
        "BodyTwist": [_core.BodyTwist(nan, nan, nan), _core.BodyTwist(1e300, 1e300, 1e300)],
        "ActuatorModel": [
            _core.ActuatorModel(nan, nan, nan, nan, nan),
            _core.ActuatorModel(1e300, 0, 1e300, 0, 0),
        ],
        "Estimate": [_core.Estimate(np.zeros(9), np.eye(9)), _core.Estimate(zero[:0], np.zeros((0, 0)))],
        "InputHistory": [_core.InputHistory(zero, zero, zero, zero), _core.InputHistory(*[zero[:0]] * 4)],
        "LeastSquaresFit": [_thesis.fit_least_squares(np.ones((9, 5)), np.ones(9), np.ones(9))],
        "MotionModel": [larger, _core.MotionModel(_core.Basis("none", [], [], []), False, False)],
        "Pose2": [_core.Pose2(nan, nan, nan), _core.Pose2(1e300, -1e300, 1e300)],
        "RegressionExample": [_thesis.RegressionExample(np.ones(5), nan, 1.0)],
        "Ground": [_core.Ground.measured(np.full((2, 3), nan)), _core.Ground.grade(1e300, nan)],
        "Segment": [wide, late, backward, long, _core.Segment(nan, nan, _core.Pose2(0, 0, 0), None, 0, 0)]
        + [each.with_ground(_core.Ground.grade(0.1, nan)) for each in (late, long)],
        "SegmentLinearization": [path],
        "SegmentPath": [path.path],
        "SteadySegment": [_thesis.SteadySegment(_core.BodyTwist(1, 0, 0), zero[:0], np.zeros((0, 3)))],
        "DisturbanceModel": [_core.DisturbanceModel([], zero[:0])],
    }
    yield from ((f"another {kind} {number}", other) for number, other in enumerate(others.get(kind, [])))

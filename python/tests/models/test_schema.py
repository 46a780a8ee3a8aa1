# SPDX-License-Identifier: Apache-2.0
"""Sections of a model file hold what fits together, and refuse the rest by a sentence."""

from __future__ import annotations

import pytest
import yaml
from pydantic import BaseModel, ValidationError
from sample_models import Made, make_model

from slipwise import _core
from slipwise.models.car import KnotCurveSection
from slipwise.models.schema import (
    LARGEST,
    HeldOut,
    ModelFile,
    SurfaceBasis,
    SurfaceMemorySection,
    SurfaceSection,
)

CURVE = {"at": [0.0, 1.0], "value": [0.0, 2.0], "std": [0.1, 0.1]}
BASIS = {
    "slip": [0.1, 0.2],
    "covariance": [[0.1, 0.0], [0.0, 0.1]],
    "by_robot": [[0.0], [0.0]],
    "robot": [0.3],
    "variance_scale": [1.0, 1.0, 1.0],
}
MEMORY = {"observed": 3, "prior_speeds": [1.0, 1.0], "weights": {"edd-2": 1.0}, "bases": {"edd-2": BASIS}}
LIMIT = {
    "name": "limits.speed.saturation",
    "stage": "limits",
    "unit": "m/s",
    "value": 1.0,
    "std": 0.1,
    "prior_std": 1.0,
    "identifiable": True,
}
SURFACE = {
    "name": "sand",
    "seconds": 9.0,
    "segments": 3,
    "visits": 1,
    "speed": 1.0,
    "yaw_rate": 1.0,
    "slip": [0.1, 0.2],
    "covariance": [[0.1, 0.0], [0.0, 0.1]],
}
SOUND: dict[type[BaseModel], dict[str, object]] = {
    KnotCurveSection: CURVE,
    SurfaceBasis: BASIS,
    SurfaceMemorySection: MEMORY,
    SurfaceSection: SURFACE,
    ModelFile: yaml.safe_load(make_model(Made(_core.named_basis("edd-2"))).to_yaml()),
}
WRONG: list[tuple[type[BaseModel], dict[str, object], str]] = [
    (KnotCurveSection, {"std": [0.1]}, "a curve needs a value and a deviation at each knot"),
    (KnotCurveSection, {"at": [1.0, 1.0]}, "the knots of a curve must increase"),
    (KnotCurveSection, {"at": [0.0, 2.0 * LARGEST]}, "less than or equal to"),
    (SurfaceBasis, {"covariance": [[0.1, 0.0]]}, "covariance of a basis must have 2 rows of 2"),
    (SurfaceBasis, {"by_robot": [[0.0], []]}, "by_robot of a basis must have 2 rows of 1"),
    (SurfaceMemorySection, {"weights": {"edd-2": 0.0}}, "needs a weight for each basis, not all of them 0"),
    (SurfaceMemorySection, {"weights": {"ipem-9": 1.0}}, "needs a weight for each basis"),
    (SurfaceSection, {"covariance": [[0.1], [0.1]]}, "covariance of a surface must have 2 rows of 2"),
    (SurfaceSection, {"name": "a" * 81}, "at most 80 characters"),
    (ModelFile, {"surfaces": [SURFACE, SURFACE]}, "two surfaces have one name"),
    (
        ModelFile,
        {"surfaces": [SURFACE | {"slip": [0.1], "covariance": [[0.1]]}]},
        "the surface 'sand' needs 2 values, one per slip parameter",
    ),
    (
        ModelFile,
        {
            "parameters": [LIMIT],
            "covariance": [[0.01]],
            "limit_gains": [1.0, 1.0],
        },
        "limits are of commands, and this model has no lag and delay of commands",
    ),
    (ModelFile, {"limit_gains": [1.0, 1.0]}, "limit_gains belong to limits of the drive"),
]


def test_sound_sections_are_read_and_written_alike() -> None:
    for section, content in SOUND.items():
        made = section.model_validate(content)
        assert section.model_validate(made.model_dump()) == made


def test_what_does_not_fit_together_is_refused_in_a_sentence(subtests: pytest.Subtests) -> None:
    for section, change, message in WRONG:
        with (
            subtests.test(section=section.__name__, message=message),
            pytest.raises(ValidationError, match=message),
        ):
            section.model_validate(SOUND[section] | change)


def test_errors_without_positions_are_of_turns_alone() -> None:
    turns = HeldOut(
        horizon=5.0, segments=9, position=0.0, heading=0.1, baseline_position=0.0, baseline_heading=0.2
    )
    assert turns.turns_alone
    assert not turns.model_copy(update={"baseline_position": 1.0}).turns_alone
    assert not turns.model_copy(update={"segments": 0}).turns_alone

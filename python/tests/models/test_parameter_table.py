# SPDX-License-Identifier: Apache-2.0
"""One table of all that was learned: what differs in any row is said, and nothing is lost on the way."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from sample_cars import true_car
from sample_models import LIMITS, Made, make_model

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.models import Model, load_model
from slipwise.models.difference import differences
from slipwise.models.parameter_table import physical_name


def learned_car() -> _core.CarCurves:
    """The true car, known to 2 % of its full speed and curvature; neighbours on a curve are alike."""
    car = true_car()
    curves = len(car.speed.at) + len(car.curvature.at)
    at = np.arange(len(car.numbers))
    covariance = 0.02**2 * np.exp(-np.abs(at[:, None] - at) / 2.0)
    covariance[curves:, :curves] = covariance[:curves, curves:] = 0.0
    return car.with_spread(covariance, np.full(len(at), 0.5))


def of_every_kind() -> dict[str, Model]:
    """Models that have each kind of row between them."""
    basis = _core.named_basis("drive-5")
    return {
        "limits": make_model(Made(basis, {"gain_v": 0.9}, response=True, limits=LIMITS)),
        "clock and sensor": make_model(
            Made(basis, clock_offset=0.05, sensor_extrinsics=(0.3, 0.1, 0.2), fraction=0.02)
        ),
        "delays": make_model(Made(basis, delays=(0.2, 0.3))),
        "car": make_model(
            Made(_core.named_basis("edd-2"), commands=True, car=learned_car(), speed=(-1.0, 2.6))
        ),
    }


def test_models_that_differ_by_five_sigma_in_any_row_are_said_to_differ() -> None:
    missed, stages = [], set()
    for kind, model in of_every_kind().items():
        table = model.table
        for i, row in enumerate(table.rows):
            moved = table.values.copy()
            moved[i] += 5.0 * math.sqrt(2.0) * row.std  # of both together
            other = model.with_table(table.moved(moved, table.covariance))
            stages.add(row.stage)
            if physical_name(row.name) not in [d.name for d in differences(model, other) if d.different]:
                missed.append(f"{kind}: {row.name}")
        assert not any(each.different for each in differences(model, model))
    assert stages == {"slip", "actuator", "clock", "sensor", "limits", "car"}
    assert not missed


def test_a_table_comes_back_from_its_file_and_from_the_core(tmp_path: Path) -> None:
    for kind, model in of_every_kind().items():
        again = load_model(model.save(tmp_path / "m.yaml"))
        assert again.content == model.content, kind
        assert np.array_equal(again.table.covariance, model.table.covariance), kind
        assert again.vector.names == [info.name for info in again.motion.parameters], kind
        assert np.array_equal(again.mean, model.vector.values), kind
        car = again.car
        of_car = model.table.of("car")
        if car is not None:
            assert np.array_equal(car.numbers, of_car.values)
            assert np.array_equal(np.array(car.covariance), of_car.covariance)


def test_what_a_newer_slipwise_writes_is_not_left_out_in_silence() -> None:
    model = make_model(Made(_core.named_basis("edd-2"), clock_offset=0.1))
    first, *rest = model.content.parameters
    for changed in (
        {"branches": {"wet": 1.0}},
        {"message": {"throttle": "servo.throttle"}},
        {"parameters": [first.model_copy(update={"branch": "wet"}), *rest]},
        {"parameters": [first.model_copy(update={"sensor": "gnss"}), *rest]},
        {"parameters": [first.model_copy(update={"input": "wheel"}), *rest]},
    ):
        with pytest.raises(ModelError, match="does not know how to use"):
            Model(model.content.model_copy(update=changed))

# SPDX-License-Identifier: Apache-2.0
"""Places and clocks of further sensors stand in the model's table, and nothing that predicts reads them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from sample_models import make_model, named, with_further_sensors

from slipwise.errors import ModelError
from slipwise.models import Model, load_model
from slipwise.models.difference import differences
from slipwise.models.mounted import Mounted, mounted_sensors, mounted_sentences
from slipwise.planning import rollout
from slipwise.prediction import predict

MADE = replace(named("full-linear-6", lon__V=-0.1, ang__w=-0.3), commands=True, clock_offset=0.05)
COMMANDS = np.array([[0.0, 1.0, 0.3], [0.4, 0.5, -0.7], [1.1, 0.2, 0.9]])


@pytest.fixture
def plain() -> Model:
    return make_model(MADE)


@pytest.fixture
def model(plain: Model) -> Model:
    return with_further_sensors(plain)


def test_they_come_back_from_the_file(model: Model, tmp_path: Path) -> None:
    again = load_model(model.save(tmp_path / "m.yaml"))
    assert again.content == model.content
    rtk, gyro = mounted_sensors(again)
    assert rtk == Mounted("/rtk", (0.45, 0.01), (-0.2, 0.02), None, (0.12, 0.003))
    assert (gyro.name, gyro.placed, gyro.late) == ("gyro_z", False, (-0.18, 0.004))
    assert again["scale(gyro_z)"].value == 1.02
    of_rtk, of_gyro = mounted_sentences((rtk, gyro))
    assert of_rtk.startswith("/rtk sits 0.450 ± 0.010 m ahead and 0.20 ± 0.02 m to the right, is stamped ")
    assert of_gyro == "gyro_z is stamped 0.180 ± 0.004 s earlier than the first source."


def test_a_model_of_one_source_has_none(plain: Model) -> None:
    assert mounted_sensors(plain) == ()


def test_predictions_are_those_without_them(plain: Model, model: Model) -> None:
    assert model.vector.names == plain.vector.names
    assert model.body.content == plain.body.content
    ours, theirs = (predict(each, COMMANDS, horizon=3.0) for each in (model, plain))
    np.testing.assert_array_equal(ours.poses, theirs.poses)
    np.testing.assert_array_equal(ours.covariance, theirs.covariance)
    commands = np.tile(COMMANDS[:, 1:], (2, 4, 1))
    results = [rollout(each, commands, 0.1, covariance=True) for each in (model, plain)]
    np.testing.assert_array_equal(results[0].path, results[1].path)
    np.testing.assert_array_equal(results[0].covariance, results[1].covariance)


def test_a_sensor_that_was_moved_differs(plain: Model, model: Model) -> None:
    values = model.table.values.copy()
    values[model.table.names.index("sensor_x(/rtk)")] += 0.1
    moved = model.with_table(model.table.moved(values, model.table.covariance))
    assert [d.name for d in differences(model, moved) if d.different] == ["sensor_x(/rtk)"]
    alone = {d.name: d for d in differences(plain, model)}["late(/rtk)"]
    assert (alone.first, alone.second, alone.different) == (None, (0.12, 0.003), False)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("name", "sensor_z(/rtk)", "does not know how to use"),
        ("unit", "cm", "does not know how to use"),
        ("sensor", "gnss", "does not know how to use"),
        ("name", "sensor_y(/rtk)", "two parameters have one name"),
    ],
)
def test_rows_that_fit_nothing_are_refused(
    model: Model, key: str, value: str, message: str, tmp_path: Path
) -> None:
    content = yaml.safe_load(model.to_yaml())
    (row,) = (row for row in content["parameters"] if row["name"] == "sensor_x(/rtk)")
    row[key] = value
    path = tmp_path / "other.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(ModelError, match=message):
        load_model(path)

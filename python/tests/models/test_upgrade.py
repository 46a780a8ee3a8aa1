# SPDX-License-Identifier: Apache-2.0
"""Files of older schemas hold the same model under older names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from older_models import MODELS, as_it_was, as_sections, older
from sample_cars import true_car
from sample_models import Made, make_model

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.models import load_model


@pytest.mark.parametrize("made", MODELS.values(), ids=MODELS)
def test_a_model_of_the_schemas_before_is_the_same_model(made: Made, tmp_path: Path) -> None:
    model = make_model(made)
    path = older(model, 3, tmp_path / "old.yaml")
    assert "slip_disturbance" not in path.read_text(encoding="utf-8")
    for version in (3, 4):
        assert load_model(older(model, version, path)).to_yaml() == model.to_yaml()


def test_a_car_of_the_schema_before_is_the_same_car(tmp_path: Path) -> None:
    model = make_model(Made(_core.named_basis("edd-2"), commands=True, car=true_car()))
    again = load_model(older(model, 4, tmp_path / "old.yaml"))
    assert again.car is not None
    assert model.car is not None
    assert np.array_equal(again.car.numbers, model.car.numbers)
    assert "car.lag" not in [row.name for row in again.table.rows if row.identifiable]


def test_a_car_that_was_learned_without_a_delay_has_none(tmp_path: Path) -> None:
    content = yaml.safe_load(
        make_model(Made(_core.named_basis("edd-2"), commands=True, car=true_car())).to_yaml()
    )
    at = [row["name"] for row in content["parameters"]].index("car.delay")
    numbers = np.delete(np.delete(np.array(content["covariance"]), at, axis=0), at, axis=1)
    del content["parameters"][at]
    path = tmp_path / "old.yaml"
    path.write_text(yaml.safe_dump(content | {"covariance": numbers.tolist()}), encoding="utf-8")
    model = load_model(path)
    assert model.car is not None
    assert model.car.delay == 0.0
    assert np.array_equal(np.delete(np.delete(model.table.covariance, at, axis=0), at, axis=1), numbers)


def test_a_wrong_section_of_the_schema_before_is_refused_by_its_name(tmp_path: Path) -> None:
    content = as_sections(make_model(MODELS["commands with limits"])) | {"slipwise_model": 4}
    for wrong, message in (({"limits": {"speed": {}}}, "missing"), ({"car": "red"}, "table of keys")):
        path = tmp_path / "wrong.yaml"
        path.write_text(yaml.safe_dump(content | wrong), encoding="utf-8")
        with pytest.raises(ModelError, match=message):
            load_model(path)


def test_older_names_are_refused_in_a_file_of_this_schema(tmp_path: Path) -> None:
    path = tmp_path / "mixed.yaml"
    content = as_it_was(as_sections(make_model(MODELS["wheels"])))
    assert isinstance(content, dict)
    path.write_text(yaml.safe_dump(content | {"slipwise_model": 4}), encoding="utf-8")
    with pytest.raises(ModelError, match=r"there is no such key|is missing"):
        load_model(path)


def test_what_a_model_was_learned_with_is_renamed_too(tmp_path: Path) -> None:
    content = as_it_was(as_sections(make_model(MODELS["wheels"])))
    assert isinstance(content, dict)
    content["slipwise_model"] = 2
    content["provenance"]["settings"] = {
        "mount": {"x": 0.2},
        "window": {"length": 1.9},
        "prior": {"lag": 0.2},
    }
    path = tmp_path / "old.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    assert load_model(path).content.provenance.settings == {
        "sensor_extrinsics": {"x": 0.2},
        "segment": {"length": 1.9},
        "prior": {"time_constant": 0.2},
    }

# SPDX-License-Identifier: Apache-2.0
"""Files of older schemas hold the same model under older names."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from older_models import MODELS, as_it_was, older
from sample_models import Made, make_model

from slipwise.errors import ModelError
from slipwise.models import load_model


@pytest.mark.parametrize("made", MODELS.values(), ids=MODELS)
def test_a_model_of_the_schema_before_is_the_same_model(made: Made, tmp_path: Path) -> None:
    model = make_model(made)
    path = older(model, 3, tmp_path / "old.yaml")
    assert "slip_disturbance" not in path.read_text(encoding="utf-8")
    assert load_model(path).to_yaml() == model.to_yaml()


def test_older_names_are_refused_in_a_file_of_this_schema(tmp_path: Path) -> None:
    path = older(make_model(MODELS["wheels"]), 4, tmp_path / "mixed.yaml")
    with pytest.raises(ModelError, match=r"there is no such key|is missing"):
        load_model(path)


def test_what_a_model_was_learned_with_is_renamed_too(tmp_path: Path) -> None:
    content = as_it_was(yaml.safe_load(make_model(MODELS["wheels"]).to_yaml()))
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

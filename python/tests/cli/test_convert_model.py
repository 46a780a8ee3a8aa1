# SPDX-License-Identifier: Apache-2.0
"""`slipwise convert` writes a model of an older version anew, and never over its input."""

from __future__ import annotations

from pathlib import Path

from older_models import MODELS, older
from sample_models import make_model

from slipwise.cli.main import run
from slipwise.models import load_model


def test_an_older_model_is_written_beside_it(tmp_path: Path) -> None:
    model = make_model(MODELS["commands with limits"])
    source = older(model, 3, tmp_path / "husky.yaml")
    before = source.read_bytes()
    assert run(["convert", str(source)]) == 0
    assert source.read_bytes() == before
    written = tmp_path / "husky-schema5.yaml"
    assert written.read_text(encoding="utf-8") == model.to_yaml()
    assert load_model(written).content == model.content


def test_a_model_goes_where_it_is_asked_and_not_over_itself(tmp_path: Path) -> None:
    source = older(make_model(MODELS["wheels"]), 2, tmp_path / "a.yaml")
    assert run(["convert", str(source), "-o", str(tmp_path / "b.yaml")]) == 0
    assert load_model(tmp_path / "b.yaml").content.slipwise_model == 5
    assert run(["convert", str(source), "-o", str(source)]) == 2


def test_one_model_at_a_time_and_a_log_needs_a_place(tmp_path: Path) -> None:
    source = older(make_model(MODELS["wheels"]), 2, tmp_path / "a.yaml")
    assert run(["convert", str(source), str(source)]) == 2
    assert run(["convert", str(tmp_path / "drive.csv")]) == 2

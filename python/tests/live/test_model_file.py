# SPDX-License-Identifier: Apache-2.0
"""A node that begins with a model reads its file once, and a file that has changed again."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_models import make_model, named
from sample_surfaces import FIRM, LOOSE, model_of_floors
from scripted_node import Scripted

from slipwise.calibration import Settings
from slipwise.cli.live_parts import live_settings, with_memory
from slipwise.errors import ModelError
from slipwise.live import model_file
from slipwise.live.build import build_node
from slipwise.live.model_file import model_in
from slipwise.models import Model, load_model


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    read: list[str] = []

    def counted(path: str) -> Model:
        read.append(path)
        return load_model(path)

    model_file._read.cache_clear()
    monkeypatch.setattr(model_file, "load_model", counted)
    return read


@pytest.mark.slow
def test_start_and_memory_of_one_file_read_it_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reads: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    model_of_floors(FIRM, LOOSE).save(Path("model.yaml"))
    settings = live_settings(Settings(), {"model": "model.yaml", "memory": True})
    settings = with_memory(settings)
    built = build_node(Scripted([]), "wheel", settings, run="test")
    assert built.learning.start is not None
    assert reads == ["model.yaml"]


def test_a_file_that_has_changed_is_read_again(tmp_path: Path, reads: list[str]) -> None:
    path = tmp_path / "model.yaml"
    make_model(named("edd-2")).save(path)
    assert model_in(str(path)) is model_in(str(path))
    make_model(named("edd-2", ang__w=-0.25)).save(path)
    assert model_in(str(path)).parameters["ang.w"].value == -0.25
    assert len(reads) == 2


def test_a_file_that_is_missing_is_said() -> None:
    with pytest.raises(ModelError, match=r"nowhere\.yaml"):
        model_in("nowhere.yaml")

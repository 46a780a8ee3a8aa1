# SPDX-License-Identifier: Apache-2.0
"""Model files by the names that tables show."""

from pathlib import Path

import pytest
from sample_models import make_model, named

from slipwise.cli.model_names import named_models
from slipwise.errors import SettingsError


def written(path: Path) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text(make_model(named("edd-2")).to_yaml())
    return path


def test_one_model_is_called_model(tmp_path: Path) -> None:
    assert list(named_models([written(tmp_path / "a.yaml")])) == ["model"]


def test_several_are_called_by_their_files_or_paths_where_names_repeat(tmp_path: Path) -> None:
    paths = [written(tmp_path / place) for place in ("a.yaml", "one/b.yaml", "two/b.yaml")]
    assert list(named_models(paths)) == ["a.yaml", str(paths[1]), str(paths[2])]


def test_a_file_that_is_given_twice_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "a.yaml")
    with pytest.raises(SettingsError, match="given twice"):
        named_models([path, path])

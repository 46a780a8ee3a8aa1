# SPDX-License-Identifier: Apache-2.0
"""The model file that a node begins with, read once however often it is looked at while the node starts."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from slipwise.calibration.live_table import LiveTable
from slipwise.models import Model, load_model


def model_in(path: str) -> Model:
    """Return the model in a file; a file that has changed meanwhile is read again.

    Raises:
        ModelError: the file is missing, not plain YAML, or does not fit this schema version.
    """
    try:
        now = Path(path).stat()
    except OSError:
        return load_model(path)  # says what is wrong
    return _read(path, now.st_mtime_ns, now.st_size, now.st_ino)


def surfaces_before(table: LiveTable) -> Model | None:
    """Return the start model where a memory begins with the surfaces in it.

    Raises:
        ModelError: the file cannot be read.
    """
    model = model_in(table.model) if table.memory and table.model is not None else None
    return model if model is not None and model.content.surfaces else None


@lru_cache(maxsize=1)
def _read(path: str, _changed: int, _size: int, _file: int) -> Model:
    return load_model(path)

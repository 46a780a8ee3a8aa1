# SPDX-License-Identifier: Apache-2.0
"""The model file that a node begins with, read once however often it is looked at while the node starts."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

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


@lru_cache(maxsize=2)  # a start model, and one with surfaces
def _read(path: str, _changed: int, _size: int, _file: int) -> Model:
    return load_model(path)

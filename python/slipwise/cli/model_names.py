# SPDX-License-Identifier: Apache-2.0
"""Model files given on the command line, by the names that tables show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.models import Model


def named_models(paths: Sequence[Path]) -> dict[str, Model]:
    """Return the models by name: `model` for one, else the names of files, or paths where these repeat.

    Raises:
        SettingsError: a file is given twice.
        ModelError: a file is no model.
    """
    from slipwise.errors import SettingsError
    from slipwise.models import load_model

    if len(paths) == 1:
        return {"model": load_model(paths[0])}
    repeated = Counter(path.name for path in paths)
    names = [path.name if repeated[path.name] == 1 else str(path) for path in paths]
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise SettingsError("a model file is given twice", where=twice[0], advice="give each once")
    return {name: load_model(path) for name, path in zip(names, paths, strict=True)}

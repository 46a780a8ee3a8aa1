# SPDX-License-Identifier: Apache-2.0
"""Several models from one input, where each may answer from both."""

from __future__ import annotations

from collections.abc import Mapping

from slipwise.models.inputs import input_name_of
from slipwise.models.model import Model


def of_common_input(models: Mapping[str, Model], asked: str | None = None) -> dict[str, Model]:
    """Return the models from the input asked for, else from the first one that all of them answer from.

    They stay as they are where they have none in common: whoever uses them says so.

    Raises:
        SettingsError: there is no such input.
    """
    if not models:
        return {}
    first = next(iter(models.values()))
    wanted = first.inputs if asked is None else (input_name_of(asked),)
    for name in wanted:
        if all(name in model.inputs for model in models.values()):
            return {key: model.of_input(name) for key, model in models.items()}
    return dict(models)

# SPDX-License-Identifier: Apache-2.0
"""A model on one of the surfaces that it remembers."""

from __future__ import annotations

import numpy as np

from slipwise.errors import ModelError
from slipwise.models.model import Model


def on_surface(model: Model, name: str) -> Model:
    """Return the model where the surface `name` is driven on: its slip, and the robot as it is known.

    Raises:
        ModelError: the model remembers no surface of this name.
    """
    content = model.content
    surface = next((each for each in content.surfaces if each.name == name), None)
    if surface is None:
        known = ", ".join(each.name for each in content.surfaces)
        raise ModelError(
            f"the model remembers no surface {name!r}",
            where="--surface",
            advice=f"it remembers {known}" if known else "it was learned without a memory of surfaces",
        )
    size = len(surface.slip)
    covariance = model.covariance
    covariance[:size, :] = 0.0
    covariance[:, :size] = 0.0
    covariance[:size, :size] = surface.covariance
    stds = np.sqrt(np.diag(covariance))
    parameters = [
        parameter.model_copy(update={"value": surface.slip[i], "std": float(stds[i])})
        if i < size
        else parameter
        for i, parameter in enumerate(content.parameters)
    ]
    return Model(content.model_copy(update={"parameters": parameters, "covariance": covariance.tolist()}))

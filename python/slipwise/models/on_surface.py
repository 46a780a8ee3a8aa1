# SPDX-License-Identifier: Apache-2.0
"""A model on one of the surfaces that it remembers, and their names."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import ModelError
from slipwise.models.model import Model
from slipwise.models.schema import LONGEST_NAME, ModelFile, SurfaceSection


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
    values, covariance = model.table.values.copy(), model.table.covariance.copy()
    values[:size] = surface.slip
    covariance[:size, :] = 0.0
    covariance[:, :size] = 0.0
    covariance[:size, :size] = surface.covariance
    return model.with_table(model.table.moved(values, covariance), **_noise(content, surface))


def renamed(model: Model, old: str, new: str) -> Model:
    """Return the model with another name for one of its surfaces.

    Raises:
        ModelError: there is no such surface, the new name is taken, empty or too long.
    """
    names = [each.name for each in model.content.surfaces]
    if old not in names:
        known = ", ".join(names)
        raise ModelError(f"the model remembers no surface {old!r}", advice=f"it remembers {known or 'none'}")
    if new in names or not new.strip() or len(new) > LONGEST_NAME:
        what = "taken" if new in names else f"not of 1 to {LONGEST_NAME} characters"
        raise ModelError(f"the name {new[:LONGEST_NAME]!r} is {what}", advice="give another name")
    surfaces = [
        each.model_copy(update={"name": new}) if each.name == old else each for each in model.content.surfaces
    ]
    return Model(model.content.model_copy(update={"surfaces": surfaces}))


def _noise(content: ModelFile, surface: SurfaceSection) -> dict[str, object]:
    """The noise of driving on the surface, and the weights of the bases there, where these are remembered."""
    memory = surface.memory
    if memory is None:
        return {}
    scale = noise_on(content, surface).tolist()
    return {
        "noise": content.noise.model_copy(update={"variance_scale": scale}),
        "weights": dict(memory.weights),
    }


def noise_on(content: ModelFile, surface: SurfaceSection) -> NDArray[np.float64]:
    """Return the factors [3] of the noise's variances on a surface: the model's, where none is remembered."""
    memory = surface.memory
    if memory is None:
        return np.array(content.noise.variance_scale, dtype=np.float64)
    scales = np.array([basis.variance_scale for basis in memory.bases.values()])
    weights = np.array([memory.weights[name] for name in memory.bases])
    return np.asarray(weights @ scales / weights.sum(), dtype=np.float64)

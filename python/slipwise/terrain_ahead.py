# SPDX-License-Identifier: Apache-2.0
"""Surfaces that a path leads to, from whoever sees them: each step slips as where it will be driven."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.errors import ModelError, SettingsError
from slipwise.models.model import Model
from slipwise.models.on_surface import noise_on
from slipwise.models.schema import SurfaceSection

Floats = NDArray[np.float64]

_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class TerrainAhead:
    """Probabilities of surfaces in stretches along the path, which begin at distances from its start.

    Distances are what the robot moves ahead or back. What probabilities leave to 1 is a surface that was
    never driven: it slips as the prior says that is shrunk over those that the model remembers.

    Raises:
        SettingsError: distances do not begin at 0 or do not increase, or probabilities are none.
    """

    distance: ArrayLike  # [K] m where each stretch begins; the first 0, the last goes on
    probability: Mapping[str, ArrayLike]  # [K] of each name; a number where it is the same in all stretches
    classes: bool = False  # names are classes of appearance: on which surface each was felt is in the model

    def __post_init__(self) -> None:
        distance = _numbers("distances", self.distance)
        if not (
            distance.ndim == 1 and len(distance) and distance[0] == 0.0 and (np.diff(distance) > 0.0).all()
        ):
            raise SettingsError(
                "the distances of stretches must begin with 0 and increase",
                where="terrain ahead",
                advice="such as distance=[0.0, 2.5]",
            )
        columns = {name: _column(name, given, len(distance)) for name, given in self.probability.items()}
        total = sum(columns.values(), np.zeros(len(distance)))
        if not columns or (total > 1.0 + _ROUNDING).any():
            raise SettingsError(
                "the probabilities of one stretch add up to more than 1"
                if columns
                else "no surface is named",
                where="terrain ahead",
                advice='such as probability={"sand": [0.9, 0.1], "grass": [0.1, 0.9]}',
            )
        object.__setattr__(self, "distance", distance)
        object.__setattr__(self, "probability", columns)

    def seen_by(self, model: Model) -> SlipAhead:
        """Return the slip of a model along the path.

        Raises:
            ModelError: the model remembers no surfaces, or none of a name.
        """
        surfaces = model.content.surfaces
        if not surfaces:
            raise ModelError(
                "the model remembers no surfaces to come to",
                where="terrain ahead",
                advice="learn it with `slipwise calibrate --memory LOG...`",
            )
        odds = _odds(self, surfaces)
        slips, covariances, scales = _moments(model, surfaces)
        edges = np.asarray(self.distance)[1:].tolist()
        return SlipAhead(_core.MixedAhead(edges, odds, slips, covariances, scales))

    def after(self, travelled: float) -> TerrainAhead:
        """Return what is ahead once the robot has moved so far [m] along the path.

        Raises:
            SettingsError: the distance is negative or not finite.
        """
        if not (np.isfinite(travelled) and travelled >= 0.0):
            raise SettingsError(f"{travelled:g} m is not a distance travelled", where="terrain ahead")
        distance = np.asarray(self.distance)
        first = int(np.searchsorted(distance, travelled, side="right")) - 1
        rest = np.maximum(distance[first:] - travelled, 0.0)
        return TerrainAhead(
            rest, {name: np.asarray(each)[first:] for name, each in self.probability.items()}, self.classes
        )


@dataclass(frozen=True, eq=False)
class SlipAhead:
    """The slip of one model along a path, as the core takes it."""

    in_core: _core.MixedAhead

    @property
    def variance_scale(self) -> Floats:
        """The factors of the noise's variances [3]: the largest of all stretches."""
        return np.asarray(self.in_core.noise_scale.max(axis=0))

    def parameters(self, model: Model) -> Floats:
        """Return the parameters of the model where the path begins."""
        mean = model.mean
        mean[: len(self.in_core.slip)] = self.in_core.slip
        return mean

    def covariance(self, model: Model) -> Floats:
        """Return the covariance of what is the robot's: that of slip is in the stretches."""
        covariance, size = model.covariance, len(self.in_core.slip)
        covariance[:size, :] = 0.0
        covariance[:, :size] = 0.0
        return covariance


def slip_ahead(ahead: TerrainAhead | None, model: Model) -> SlipAhead | None:
    """Return the slip of a model along the path, or None where nothing is said of it.

    Raises:
        ModelError: the model remembers no surfaces, or none of a name.
    """
    return None if ahead is None else ahead.seen_by(model)


def _odds(ahead: TerrainAhead, surfaces: Sequence[SurfaceSection]) -> Floats:
    """Return the probability of each surface, and last of a new one, in each stretch, [K, surfaces + 1]."""
    names = [surface.name for surface in surfaces]
    odds = np.zeros((len(np.asarray(ahead.distance)), len(names) + 1))
    felt = [(surface.name, list(surface.classes.items())) for surface in surfaces]
    for name, column in ahead.probability.items():
        given = np.asarray(column)
        if ahead.classes:
            odds += given[:, None] * _core.surfaces_of_class(name, felt)
        elif name in names:
            odds[:, names.index(name)] += given
        else:
            raise ModelError(
                f"the model remembers no surface {name!r}",
                where="terrain ahead",
                advice=f"it remembers {', '.join(names)}; of what a camera names, say classes=True",
            )
    odds[:, -1] += np.maximum(1.0 - odds.sum(axis=1), 0.0)
    return np.asarray(odds / odds.sum(axis=1, keepdims=True))


def _moments(
    model: Model, surfaces: Sequence[SurfaceSection]
) -> tuple[list[Floats], list[Floats], list[Floats]]:
    """Return slip, covariance and noise scale of each surface, and last of a new one."""
    size = len(surfaces[0].slip)
    slips = [np.array(surface.slip, dtype=np.float64) for surface in surfaces]
    covariances = [np.array(each.covariance, dtype=np.float64).reshape(size, size) for each in surfaces]
    scales = [noise_on(model.content, surface) for surface in surfaces]
    known = [
        _core.SurfaceSlip(slip, covariance, np.zeros((size, 0)), np.zeros(0), (1.0, 1.0), scale)
        for slip, covariance, scale in zip(slips, covariances, scales, strict=True)
    ]
    new = _core.shrunk_prior(known, model.prior_std[:size], (1.0, 1.0))
    return (
        [*slips, np.array(new.mean)],
        [*covariances, np.array(new.covariance)],
        [*scales, np.max(scales, axis=0)],
    )


def _numbers(what: str, values: ArrayLike) -> Floats:
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise SettingsError(f"the {what} are no numbers", where="terrain ahead") from problem
    if not np.isfinite(numbers).all():
        raise SettingsError(f"the {what} are not finite", where="terrain ahead")
    return numbers


def _column(name: str, given: ArrayLike, stretches: int) -> Floats:
    column = _numbers(f"probabilities of {name}", given)
    if column.ndim > 1 or column.size not in (1, stretches):
        raise SettingsError(
            f"{column.size} probabilities of {name} for {stretches} stretches",
            where="terrain ahead",
            advice="give one for each stretch",
        )
    if (column < 0.0).any():
        raise SettingsError(f"a probability of {name} is negative", where="terrain ahead")
    return np.array(np.broadcast_to(column.ravel(), stretches))

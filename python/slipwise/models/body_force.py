# SPDX-License-Identifier: Apache-2.0
"""The force that was learned beside slip: what it does to the robot, what of that is known, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from slipwise.models.model import Model

Frame = Literal["body", "world"]

#: Squared distance from zero of so many normal numbers, as rare as three standard deviations of one.
_FAR = {1: 9.0, 2: 11.83, 3: 14.16, 4: 16.25}


_PARTS = {
    _core.ForceAxis.Ahead: "ahead",
    _core.ForceAxis.Left: "left",
    _core.ForceAxis.Moment: "turn",
    _core.ForceAxis.WorldX: "x",
    _core.ForceAxis.WorldY: "y",
}
_WORDS = {
    "ahead": "ahead (+) or back (-)",
    "left": "to its left (+) or right (-)",
    "turn": "into a turn to its left (+) or right (-)",
    "x": "along x of the poses",
    "y": "along y of the poses",
}


@dataclass(frozen=True)
class ForcePart:
    """What one part of a force does: motion per metre driven that keeps its sign when the robot reverses."""

    name: str  # "ahead", "left", "turn"; or "x", "y" of the frame of the poses
    drift: float | None  # m/m, of a turn rad/m; None where the drive does not tell it from slip
    std: float | None
    shows: bool  # beyond three standard deviations

    @property
    def unit(self) -> str:
        """Unit of the drift."""
        return "rad/m" if self.name == "turn" else "m/m"

    def __str__(self) -> str:
        if self.drift is None or self.std is None:
            return f"{_WORDS[self.name]}: not identifiable, this drive does not tell it from slip"
        amount = f"{_WORDS[self.name]}: {estimate_text(self.drift, self.std)} {self.unit}"
        return amount if self.shows else f"{amount}, which may be none"


def force_names(frame: Frame) -> tuple[str, ...]:
    """Return the names of the parameters that are a force's."""
    return tuple(_terms(frame))


@cache
def _terms(frame: Frame) -> dict[str, _core.ForceTerm]:
    """The terms of a force by the names of their parameters, as the core has them."""
    fixed_to = _core.ForceFrame.Body if frame == "body" else _core.ForceFrame.World
    basis = _core.with_force(_core.Basis("none", [], [], []), fixed_to)
    names = [info.name for info in _core.MotionModel(basis, False, False).parameters]
    return {names[term.place]: term for term in _core.force_terms(basis)}


def force_parts(
    frame: Frame,
    names: Sequence[str],
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    identifiable: Sequence[bool],
) -> tuple[ForcePart, ...]:
    """Return the estimate of each part of a force.

    Args:
        frame: what the force is fixed to.
        names: of all parameters of a model, [parameters].
        mean: their values.
        covariance: of these.
        identifiable: whether the drive determines each better than the prior.
    """
    terms, parts = _terms(frame), []
    for axis in dict.fromkeys(term.axis for term in terms.values()):
        part = _PARTS[axis]
        places = [i for i, name in enumerate(names) if name in terms and terms[name].axis == axis]
        seen = [i for i in places if identifiable[i]]
        driven = [i for i in seen if "abs(V)" in names[i]]
        if not driven:
            parts.append(ForcePart(part, None, None, False))
            continue
        signs = np.array([terms[names[i]].sign for i in driven])
        drift, std = _mean_of(
            signs * mean[driven], signs[:, None] * covariance[np.ix_(driven, driven)] * signs
        )
        distance = float(mean[seen] @ np.linalg.solve(covariance[np.ix_(seen, seen)], mean[seen]))
        parts.append(ForcePart(part, drift, std, distance > _FAR[len(seen)]))
    return tuple(parts)


def force_sentence(parts: Sequence[ForcePart]) -> str:
    """Say what pushes the robot, in words."""
    shown = [part for part in parts if part.shows]
    head = "A force pushes the robot" if shown else "No force shows beside the slip"
    return f"{head}, per distance driven; {'; '.join(map(str, parts))}."


def _mean_of(values: NDArray[np.float64], covariance: NDArray[np.float64]) -> tuple[float, float]:
    """The plain mean of what one part does along and across the robot, and its standard deviation."""
    weights = np.full(len(values), 1.0 / len(values))
    return float(weights @ values), math.sqrt(max(float(weights @ covariance @ weights), 0.0))


def without_force(model: Model) -> Model:
    """Return the model for another day, without the force that was learned beside its slip.

    The slip stays where the drive separated the force from it. Where it did not, slip is as it would
    be had there been no force.
    """
    section = model.content.body_force
    if section is None:
        return model
    content, ours = model.content, set(force_names(section.frame))
    table = model.table
    unseen = [i for i, row in enumerate(table.rows) if row.name in ours and not row.identifiable]
    kept = [i for i, name in enumerate(table.names) if name not in ours]
    known = table.moved(*_given_none(table.values, table.covariance, unseen))
    slip = {
        channel: [term for term in getattr(content.slip, channel) if f"{channel}.{term}" not in ours]
        for channel in ("lon", "lat", "ang")
    }
    return model.with_table(known.at(kept), slip=content.slip.model_copy(update=slip), body_force=None)


def _given_none(
    mean: NDArray[np.float64], covariance: NDArray[np.float64], places: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and covariance of all parameters, were those of `places` known to be zero."""
    if not places:
        return mean, covariance
    gain = np.linalg.solve(covariance[np.ix_(places, places)], covariance[places]).T
    left = covariance - gain @ covariance[places]
    return mean - gain @ mean[places], 0.5 * (left + left.T)

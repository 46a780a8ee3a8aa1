# SPDX-License-Identifier: Apache-2.0
"""How the body moves for what the drive does, over the range of the log, and straight lines through that."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.models.model import Model

Floats = NDArray[np.float64]

_GRID = 21  # speeds, and as many yaw rates


@dataclass(frozen=True)
class BodyTwists:
    """The drive's speeds and yaw rate [N] and the body's twist (forward, left, yaw) then, once settled."""

    v: Floats
    vy: Floats  # to the left
    w: Floats
    mean: Floats  # [N, 3]
    features: Floats  # [N, 3, slip parameters], derivative of `mean`

    def line(self, axis: int, *inputs: Floats) -> tuple[Floats, Floats]:
        """Return the least-squares coefficients [K] of K inputs [N] for an axis of `mean`, by number.

        Beside them their derivative [K, slip parameters]. Of an input that is always zero both are 0.
        """
        solve = np.linalg.pinv(np.column_stack(inputs))
        return solve @ self.mean[:, axis], solve @ self.features[:, axis]


def body_twists(model: Model) -> BodyTwists:
    """Return the body's twists on a grid over the range of validity."""
    span = model.content.range
    v, w = np.meshgrid(*(np.linspace(low, high, _GRID) for low, high in (span.speed, span.yaw_rate)))
    return _twists(model, v.ravel(), w.ravel())


def sideways_twists(model: Model) -> BodyTwists | None:
    """Return the body's twists while it drives to its sides alone; None where it has not."""
    span = model.content.range.sideways
    if span is None:
        return None
    vy = np.linspace(span[0], span[1], _GRID)
    return _twists(model, np.zeros_like(vy), np.zeros_like(vy), vy)


def gains_at_sides(model: Model) -> tuple[float, float]:
    """Return the gains of speed and yaw rate in front of limits of the sides; without these they are 1."""
    limits = model.limits_section
    return (1.0, 1.0) if limits is None else (limits.gain_v, limits.gain_omega)


def turning_twists(model: Model, radius: float) -> BodyTwists:
    """Return the body's twists while turning at `radius` [m] to either side, as fast as the log went."""
    span = model.content.range
    fastest = min(max(map(abs, span.speed)), radius * max(map(abs, span.yaw_rate)))
    v = np.repeat(np.linspace(fastest / _GRID, fastest, _GRID), 2)
    return _twists(model, v, v / radius * np.tile((1.0, -1.0), _GRID))


def _twists(model: Model, v: Floats, w: Floats, vy: Floats | None = None) -> BodyTwists:
    basis = model.motion.basis
    left = np.zeros_like(v) if vy is None else vy
    drive = np.column_stack((v, left, w))
    terms = tuple(basis.lon), tuple(basis.lat), tuple(basis.ang)
    features = _features(terms, drive.tobytes())
    return BodyTwists(v, left, w, drive + features @ model.mean[: basis.size], features)


@lru_cache(maxsize=4)  # a live node asks again and again over one range
def _features(terms: tuple[tuple[str, ...], ...], drive: bytes) -> Floats:
    """Return features of terms on each axis, [N, 3, slip parameters], at rows of a drive, [N, 3] as bytes."""
    rows, basis = np.frombuffer(drive).reshape(-1, 3), _core.Basis("", *terms)
    channel = np.repeat(np.arange(3), [len(each) for each in terms])
    features = np.zeros((len(rows), 3, basis.size))
    for found, (ahead, side, rate) in zip(features, rows.tolist(), strict=True):
        found[channel, np.arange(basis.size)] = basis.features(_core.SlipState(ahead, rate, 0.0, 0.0, side))
    features.flags.writeable = False
    return features

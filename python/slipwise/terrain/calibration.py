# SPDX-License-Identifier: Apache-2.0
"""Calibrates the pool of experts and the judgement "unknown", on runs and surfaces that were left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.terrain.experts import Experts
from slipwise.terrain.pool import Pool, Rejection, doubt_of, pooled
from slipwise.terrain.windows import Windows

Floats = NDArray[np.float64]
Rows = NDArray[np.bool_]

MOST_OF_A_RUN = 30.0  # windows; a longer run counts no more
EVENLY = Pool(1.0, 1.0, 0.0, 0.0, 0.0, ())  # experts before their exponents are fitted
TOWARDS_ONE = 0.01  # penalty on exponents' squared distance from 1, in nats
SHARES = tuple(float(share) for share in np.round(np.arange(0.05, 0.96, 0.05), 2))


@dataclass(frozen=True)
class LeftOut:
    """What experts say about windows that they have not learned from; NaN where there is nothing."""

    vibration: Floats  # [S, N, K], for each shape of the kernel
    newness: Floats  # [S, N]
    current: Floats  # [N, K]

    @staticmethod
    def empty(windows: int, surfaces: int, shapes: int) -> LeftOut:
        """Return one that is to be filled."""
        return LeftOut(
            np.full((shapes, windows, surfaces), np.nan),
            np.zeros((shapes, windows)),
            np.full((windows, surfaces), np.nan),
        )

    def fill(self, chosen: Rows, experts: Experts, windows: Windows) -> None:
        """Write down what the experts say about the windows that are chosen, [N]."""
        rows = chosen & windows.has_vibration
        for k, expert in enumerate(experts.vibration if rows.any() else ()):
            self.vibration[k, rows] = expert.probabilities(windows.vibration[rows])
            self.newness[k, rows] = expert.newness(windows.vibration[rows])
        rows = chosen & windows.has_current
        if experts.current is not None and rows.any():
            self.current[rows] = experts.current.probabilities(windows.current[rows])

    def best_shape(self, windows: Windows, surfaces: Sequence[str]) -> int:
        """Return the shape whose probabilities, with those of the currents, are best by the log score."""
        truth = _truth(windows, surfaces)
        current = np.where(np.isfinite(self.current), self.current, 1.0)
        losses = []
        for vibration in self.vibration:
            rows = np.isfinite(vibration).all(axis=1)
            joint = pooled(EVENLY, vibration[rows], current[rows])
            own = joint[np.arange(rows.sum()), truth[rows]]
            losses.append(float(-np.log(own).mean()) if rows.any() else 0.0)
        return int(np.argmin(losses))

    def has(self, kind: str) -> Rows:
        """Return the windows about which the experts of this kind said something, [N]."""
        vibration, current = np.isfinite(self.vibration[0]).all(axis=1), np.isfinite(self.current).all(axis=1)
        return np.asarray({"vibration": vibration, "current": current, "both": vibration & current}[kind])


@dataclass(frozen=True)
class HeldOut:
    """What a pool is fitted to."""

    kind: str  # "vibration", "current" or "both"
    known: LeftOut  # of experts that know all surfaces, but not the run
    strangers: tuple[LeftOut, ...]  # of experts that know all surfaces but the window's; none of two surfaces
    windows: Windows
    surfaces: tuple[str, ...]


def fit_pool(held_out: HeldOut, shape: int) -> tuple[Pool, Floats, Rows]:
    """Fit exponents by the log score, then the judgement on surfaces each of which was left out once.

    Args:
        held_out: what to fit to.
        shape: index of the kernel's shape.

    Returns:
        The pool, its probabilities of the windows left out, [M, K], and which windows these are, [N].
    """
    kind, known, windows = held_out.kind, held_out.known, held_out.windows
    rows = known.has(kind)
    weight = _weights(windows, rows)
    pool = _fit_exponents(held_out, rows, weight, shape)
    probability = pooled(pool, known.vibration[shape, rows], known.current[rows])
    if not held_out.strangers:
        return pool, probability, rows
    signs = [_signs(doubt_of(probability), known.newness[shape, rows])]
    weights = [weight / weight.sum()]
    for stranger in held_out.strangers:
        own = stranger.has(kind)
        doubt = doubt_of(pooled(pool, stranger.vibration[shape, own], stranger.current[own]))
        signs.append(_signs(doubt, stranger.newness[shape, own]))
        part = _weights(windows, own)
        weights.append(part / part.sum() / len(held_out.strangers))
    return _with_judgement(pool, signs, weights, use_newness=kind != "current"), probability, rows


def _with_judgement(pool: Pool, signs: list[Floats], weights: list[Floats], *, use_newness: bool) -> Pool:
    """Fit the logistic regression of unknown on the signs, none of which may speak for known."""
    design, weight = np.concatenate(signs), np.concatenate(weights)
    unknown = np.concatenate([np.full(len(part), float(k > 0)) for k, part in enumerate(signs)])

    def loss(values: Floats) -> float:
        score = design @ values
        return float((weight * (np.logaddexp(0.0, score) - unknown * score)).sum())

    most = 10.0 if use_newness else 0.0
    offset, doubt, newness = _least(
        loss, np.array([0.0, 1.0, 0.0]), [(-50.0, 50.0), (0.0, 10.0), (0.0, most)]
    )
    odds = 1.0 / (1.0 + np.exp(-np.clip(design @ np.array([offset, doubt, newness]), -50.0, 50.0)))
    rejections = tuple(_rejection(odds, weight, unknown > 0.5, share) for share in SHARES)
    return Pool(pool.vibration, pool.current, offset, doubt, newness, rejections)


def _rejection(odds: Floats, weight: Floats, unknown: Rows, share: float) -> Rejection:
    """Return the bound that calls this share of the unknown windows unknown, or more where that is free."""
    order = np.argsort(-odds[unknown])
    found = np.cumsum(weight[unknown][order]) / weight[unknown].sum()
    bound = float(odds[unknown][order][min(int(np.searchsorted(found, share)), len(order) - 1)])
    bound = _lowered(bound, odds[~unknown])
    above = odds >= bound
    cost = weight[above & ~unknown].sum() / weight[~unknown].sum()
    return Rejection(share, float(cost), bound)


def _lowered(bound: float, known: Floats) -> float:
    """Return a bound half-way, in log odds, to the next known window below it: as cheap, and safer."""
    below = max(known[known < bound], default=0.0)
    logits = [float(np.log(odds / (1.0 - odds))) for odds in np.clip([below, bound], 1e-9, 1.0 - 1e-9)]
    return float(1.0 / (1.0 + np.exp(-sum(logits) / 2.0)))


def _fit_exponents(held_out: HeldOut, rows: Rows, weight: Floats, shape: int) -> Pool:
    used = np.array([held_out.kind != "current", held_out.kind != "vibration"], dtype=np.float64)
    vibration, current = held_out.known.vibration[shape, rows], held_out.known.current[rows]
    truth = _truth(held_out.windows, held_out.surfaces)[rows]
    index = np.arange(len(truth))

    def loss(values: Floats) -> float:
        first, second = (values * used).tolist()
        probability = pooled(Pool(first, second, 0.0, 0.0, 0.0, ()), vibration, current)
        own = np.log(np.maximum(probability[index, truth], 1e-12))
        return float(-(weight * own).sum() / weight.sum() + TOWARDS_ONE * (used * (values - 1.0) ** 2).sum())

    first, second = _least(loss, np.ones(2), [(1e-3, 10.0)] * 2)
    return Pool(first * float(used[0]), second * float(used[1]), 0.0, 0.0, 0.0, ())


def _least(loss: Callable[[Floats], float], start: Floats, bounds: list[tuple[float, float]]) -> list[float]:
    from scipy.optimize import minimize

    return [float(value) for value in minimize(loss, start, bounds=bounds, method="L-BFGS-B").x]


def _signs(doubt: Floats, newness: Floats) -> Floats:
    return np.stack([np.ones(len(doubt)), doubt, newness], axis=1)


def _weights(windows: Windows, rows: Rows) -> Floats:
    """Return weights of the chosen windows, so that no long run outweighs the others."""
    _, index, count = np.unique(windows.run[rows].astype(str), return_inverse=True, return_counts=True)
    return np.asarray(np.minimum(1.0, MOST_OF_A_RUN / count)[index])


def _truth(windows: Windows, surfaces: Sequence[str]) -> NDArray[np.int64]:
    return np.array([list(surfaces).index(name) for name in windows.label], dtype=np.int64)

# SPDX-License-Identifier: Apache-2.0
"""AMCL's two sample models of odometry, as particles (Thrun et al.: Probabilistic Robotics, table 5.6)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
NEAR = 0.01  # m; AMCL takes a shorter move for a turn on the spot


def spread(odometry: Floats, alphas: Sequence[float], *, omni: bool, count: int = 40_000) -> Floats:
    """Return the covariance [3, 3] of particles that follow odometry poses [N, 3] from one place."""
    rng = np.random.default_rng(8)
    particles = np.tile(odometry[0], (count, 1))
    for before, after in pairwise(odometry):
        (_omni if omni else _differential)(particles, (before, after), alphas, rng)
    return np.cov(particles.T)


def _differential(
    particles: Floats, move: tuple[Floats, Floats], alphas: Sequence[float], rng: np.random.Generator
) -> None:
    before, after = move
    a1, a2, a3, a4, _ = alphas
    distance, bearing = _polar(before, after)
    first = 0.0 if distance < NEAR else _wrap(bearing - before[2])
    second = _wrap(after[2] - before[2] - first)
    turns = [min(abs(turn), abs(_wrap(turn - np.pi))) for turn in (first, second)]
    n = len(particles)
    first_hat = first - rng.normal(0.0, np.sqrt(a1 * turns[0] ** 2 + a2 * distance**2), n)
    moved = distance - rng.normal(0.0, np.sqrt(a3 * distance**2 + a4 * (turns[0] ** 2 + turns[1] ** 2)), n)
    second_hat = second - rng.normal(0.0, np.sqrt(a1 * turns[1] ** 2 + a2 * distance**2), n)
    particles[:, 0] += moved * np.cos(particles[:, 2] + first_hat)
    particles[:, 1] += moved * np.sin(particles[:, 2] + first_hat)
    particles[:, 2] += first_hat + second_hat


def _omni(
    particles: Floats, move: tuple[Floats, Floats], alphas: Sequence[float], rng: np.random.Generator
) -> None:
    before, after = move
    a1, a2, a3, a4, a5 = alphas
    distance, bearing = _polar(before, after)
    turn, n = after[2] - before[2], len(particles)
    moved = distance + rng.normal(0.0, np.sqrt(a3 * distance**2 + a4 * turn**2), n)
    turned = turn + rng.normal(0.0, np.sqrt(a1 * turn**2 + a2 * distance**2), n)
    strafed = rng.normal(0.0, np.sqrt(a4 * turn**2 + a5 * distance**2), n)
    course = _wrap(bearing - before[2]) + particles[:, 2]
    particles[:, 0] += moved * np.cos(course) + strafed * np.sin(course)
    particles[:, 1] += moved * np.sin(course) - strafed * np.cos(course)
    particles[:, 2] += turned


def _polar(before: Floats, after: Floats) -> tuple[float, float]:
    dx, dy = (after - before)[:2].tolist()
    return float(np.hypot(dx, dy)), float(np.arctan2(dy, dx))


def _wrap(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)

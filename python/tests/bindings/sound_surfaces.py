# SPDX-License-Identifier: Apache-2.0
"""Arguments with which what is bound of surfaces works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from slipwise import _core

SIZE = 6  # parameters of the model below: two of slip, lags and delays


def _posterior() -> _core.MotionPosterior:
    model, estimate = _core.MotionModel(_core.named_basis("edd-2"), True, False), np.full(SIZE, 0.01)
    noise = _core.MotionNoise([1e-4] * 3, [1e-4] * 3, [0.01] * 3, 0.01, 0.01)
    known = _core.Estimate(estimate, 0.01 * np.eye(SIZE))
    return _core.MotionPosterior(model, known, np.ones(SIZE), noise, np.ones(3))


def _surface_slip() -> _core.SurfaceSlip:
    slip = np.full(2, 0.01), 0.01 * np.eye(2), np.zeros((2, 4)), np.zeros(4)
    return _core.SurfaceSlip(*slip, (1.0, 0.5), np.ones(3))


def _surface_memory() -> _core.SurfaceMemory:
    return _core.SurfaceMemory(["edd-2"], [_surface_slip()], np.ones(1), 20)


def _known_before() -> _core.KnownBefore:
    known = _core.KnownSurface("sand", (60.0, 1.0, 0.5), (24, 1), "2026-01-01", _surface_memory(), [])
    return _core.KnownBefore(_posterior(), 0, [known], (1.0, 1.0))


def _surface() -> _core.Surface:
    learner = remembering_learner()
    law = _core.DisturbanceModel([_core.SlipDisturbance(0.1, 0.1, 5.0)], np.ones(1))
    learner.begin_with(_known_before(), law, False)
    return learner.surfaces().surfaces[0]


def remembering_learner() -> _core.MotionLearner:
    """Return a learner that has learned nothing yet, and will remember surfaces."""
    settings, hypotheses = _core.LearnerSettings(), _core.HypothesisSettings()
    average, surfaces = _core.ModelAverageSettings(), _core.SurfaceSettings()
    surfaces.remember = True
    average.surfaces = surfaces
    hypotheses.bases, hypotheses.average = [_core.named_basis("edd-2")], average
    settings.hypotheses = hypotheses
    return _core.MotionLearner(settings)


SURFACE_OBJECTS: dict[str, Callable[[], Any]] = {
    "KnownBefore": _known_before,
    "Surface": _surface,
    "SurfaceMemory": _surface_memory,
    "SurfaceSlip": _surface_slip,
}
SURFACE_ARGUMENTS: dict[str, Callable[[], Any]] = {
    "SurfaceSlip.__init__ mean": lambda: np.full(2, 0.01),
    "SurfaceSlip.__init__ covariance": lambda: 0.01 * np.eye(2),
    "SurfaceSlip.__init__ by_robot": lambda: np.zeros((2, 4)),
    "SurfaceSlip.__init__ robot": lambda: np.zeros(4),
    "SurfaceSlip.__init__ noise_scale": lambda: np.ones(3),
    "SurfaceSlip.__init__ speeds": lambda: (1.0, 0.5),
    "SurfaceMemory.__init__ bases": lambda: ["edd-2"],
    "SurfaceMemory.__init__ slips": lambda: [_surface_slip()],
    "SurfaceMemory.__init__ weights": lambda: np.ones(1),
    "KnownSurface.__init__ last_seen": lambda: "2026-01-01",
    "KnownSurface.__init__ seconds_and_speeds": lambda: (60.0, 1.0, 0.5),
    "KnownSurface.__init__ segments_and_visits": lambda: (24, 1),
    "KnownBefore.__init__ surfaces": lambda: [
        _core.KnownSurface("sand", (60.0, 1.0, 0.5), (24, 1), "", _surface_memory(), [])
    ],
    "KnownBefore.__init__ labels": lambda: (1.0, 1.0),
}

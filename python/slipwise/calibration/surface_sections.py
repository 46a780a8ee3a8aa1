# SPDX-License-Identifier: Apache-2.0
"""The surfaces that a learner remembers, as the model file has them."""

from __future__ import annotations

from slipwise import _core
from slipwise.calibration.learner import CASCADED, JOINT, LIMITS, Posterior
from slipwise.models.schema import SurfaceSection


def surface_sections(learner: _core.MotionLearner, kept: Posterior) -> tuple[SurfaceSection, ...]:
    """Return the surfaces with the slip of the model that is kept.

    A model without lags has too few terms to hold what is remembered, and gets none.
    """
    if kept.structure not in (JOINT, CASCADED, LIMITS):
        return ()
    size = kept.motion.basis.size
    sections = []
    for surface in learner.surfaces().surfaces:
        state = learner.on_surface(surface)
        if state is None or len(state.estimate.mean) < size:
            continue
        speed, yaw_rate = surface.speeds
        sections.append(
            SurfaceSection(
                name=surface.name,
                seconds=surface.seconds,
                segments=surface.segments,
                visits=surface.visits,
                last_seen=surface.last_seen,
                speed=speed,
                yaw_rate=yaw_rate,
                slip=state.estimate.mean[:size].tolist(),
                covariance=state.estimate.covariance[:size, :size].tolist(),
            )
        )
    return tuple(sections)

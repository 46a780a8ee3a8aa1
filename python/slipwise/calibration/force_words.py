# SPDX-License-Identifier: Apache-2.0
"""What was learned of a force beside slip, as the verdict says it."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.learner import Posterior
from slipwise.calibration.settings import Settings
from slipwise.models.body_force import ForcePart, force_parts, force_sentence
from slipwise.models.schema import UNIDENTIFIABLE_RATIO


def force_found(posterior: Posterior, settings: Settings) -> tuple[ForcePart, ...]:
    """Return what a posterior knows of each part of the force; an empty tuple if none was to be learned."""
    frame = settings.body_force.frame
    if frame == "none":
        return ()
    identifiable = np.asarray(posterior.variance_ratio <= UNIDENTIFIABLE_RATIO).tolist()
    names = [info.name for info in posterior.motion.parameters]
    return force_parts(frame, names, posterior.mean, posterior.covariance, identifiable)


def force_words(posterior: Posterior, settings: Settings) -> str:
    """Say what pushes the robot; empty where no force was to be learned."""
    parts = force_found(posterior, settings)
    return force_sentence(parts) if parts else ""

# SPDX-License-Identifier: Apache-2.0
"""How fast the body moved by its poses, and how long inputs were held, as the model file has it."""

from __future__ import annotations

from slipwise import _core
from slipwise.models.schema import MeasuredBody


def measured_body(model: _core.LearnedModel) -> MeasuredBody:
    """Return what the learner measured beside what it learned."""
    rates = model.rates
    backward, forward = rates.speed
    right, left = rates.yaw_rate
    return MeasuredBody(
        speed=[0.0 - backward, forward],
        yaw_rate=[0.0 - right, left],
        acceleration=list(rates.acceleration),
        yaw_acceleration=list(rates.turning),
        held=list(model.held),
        seconds=rates.seconds,
    )

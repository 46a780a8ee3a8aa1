# SPDX-License-Identifier: Apache-2.0
"""Puts the state of the node together for those who watch it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from slipwise.live.applied import AppliedModel, physical
from slipwise.live.intake import Intake
from slipwise.live.learning import Learning
from slipwise.live.outputs import Odometry, ParameterNow, Path, Status, SurfaceNow
from slipwise.live.said import Said
from slipwise.models.parameter_table import physical_name
from slipwise.number_text import count_text

KEPT_POSES = 600  # measured poses that are shown
APART = 0.02  # m between two of them


@dataclass(frozen=True)
class Identity:
    """Whose state it is."""

    vehicle: str
    input: str  # "command" or "wheel"
    apply: str  # "off", "manual" or "auto"


class DrivenPath:
    """The last measured poses, thinned by distance."""

    def __init__(self) -> None:
        self._poses: deque[tuple[float, float, float]] = deque(maxlen=KEPT_POSES)

    def take(self, x: float, y: float, yaw: float) -> None:
        """Take a measured pose: x, y [m], yaw [rad]; a position (its yaw is NaN) heads away from the last."""
        if np.isnan(yaw):
            before = self._poses[-1] if self._poses else (x, y, 0.0)
            yaw = float(np.arctan2(y - before[1], x - before[0]))
        if not np.isfinite((x, y, yaw)).all():
            return
        if self._poses and np.hypot(x - self._poses[-1][0], y - self._poses[-1][1]) < APART:
            return
        self._poses.append((x, y, yaw))

    def rows(self) -> np.ndarray:
        """Return the poses [N, 3], oldest first."""
        return np.array(self._poses, dtype=np.float64).reshape(-1, 3)


@dataclass(frozen=True)
class Now:
    """What was computed for the present moment."""

    odometry: Odometry | None
    predicted: Path | None
    stuck: bool
    waits: str  # what is missing for learning
    surface: SurfaceNow | None = None


def status_of(
    who: Identity,
    parts: tuple[Learning, Intake, Said],
    parameters: tuple[ParameterNow, ...],
    driven: DrivenPath,
    now: Now,
) -> Status:
    """Return the state."""
    learning, intake, said = parts
    state, why = _state(learning, intake, now)
    newest = intake.newest_input
    slip = None
    if now.odometry is not None and newest is not None:
        slip = now.odometry.twist - np.array([newest.v, newest.vy, newest.omega])
    held_out = None
    if learning.judgement is not None and learning.judgement.held_out.segments:
        h = learning.judgement.held_out
        held_out = (h.position, h.heading, h.baseline_position, h.baseline_heading)
    return Status(
        t=intake.newest,
        vehicle=who.vehicle,
        input=who.input,
        state=state,
        why=why,
        validity=learning.validity.whole,
        validity_why=learning.validity.why,
        parameters=parameters,
        driven=driven.rows(),
        odometry=now.odometry,
        predicted=now.predicted,
        slip=slip,
        nis=learning.nis,
        held_out=held_out,
        segments=learning.segments,
        counts=dict(said.counts),
        log=said.log(),
        apply=who.apply,
        given=learning.given()[1],
        surface=now.surface,
    )


def _state(learning: Learning, intake: Intake, now: Now) -> tuple[str, str]:
    if now.stuck:
        return "stuck", "the robot does not move as the model predicts"
    if intake.newest_pose is None:
        return "waiting", "no pose yet"
    if now.waits:
        return "waiting", now.waits
    if intake.why_not:
        return "not learning", intake.why_not
    if learning.segments == 0:
        return "waiting", "no segment is complete yet"
    return "learning", f"{count_text(learning.segments, 'segment')} so far"


def parameters_now(learning: Learning, applied: AppliedModel | None) -> tuple[ParameterNow, ...]:
    """Return the parameters in physical units; none before the first judgement."""
    if learning.model is None:
        return ()
    priors = {physical_name(p.name): p for p in learning.model.content.parameters}
    rows = []
    for name, each in learning.model.parameters.items():
        prior = priors[name]
        if prior.prior_std == 0.0:
            continue  # given: a car stands without throttle
        logarithm = prior.name != name
        start = physical(name, learning.start_values)
        rows.append(
            ParameterNow(
                name=name,
                unit=each.unit,
                value=each.value,
                std=each.std,
                prior_std=prior.prior_std * (each.value if logarithm else 1.0),
                validity=learning.validity.of(prior.name),
                start=each.value if start is None else start,
                applied=None if applied is None else physical(name, applied.values),
                target_std=each.target_std,
            )
        )
    return tuple(rows)

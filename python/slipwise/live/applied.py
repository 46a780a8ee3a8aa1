# SPDX-License-Identifier: Apache-2.0
"""The model that other programs have: it follows the learned model, clipped and rate-limited."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from slipwise.live.outputs import Validity
from slipwise.models import Model
from slipwise.models.schema import Parameter, Slip, VerdictSection
from slipwise.number_text import estimate_texts, number_text

LONGEST_STEP = 5.0  # s that one step counts; judgements are no farther apart while the robot drives
CERTAIN = 3.0  # of its own standard deviations, beyond which a change from the start is no chance
# Prior standard deviations of a parameter:
WITHIN = 1.0  # beyond what is certain, a value is followed at most: a chance costs no more than the prior
FARTHEST = 4.0 * WITHIN  # beyond which nothing is followed, however certain: no robot is that far
RATE = 0.01  # a second, at most: the whole prior takes minutes, so that a controller is never surprised
THRESHOLD = 0.02  # that a parameter moved at least, before others are told: what drives do not show


class AppliedModel:
    """Where the applied parameters are, on their way from the start to what was learned.

    Limits of the drive and a car's curves are as they were learned: parts of a curve do not fit each other.
    A slip term that the start does not have starts at zero. A lag or delay that it does not have starts at
    what was learned: no number stands for none.

    `WITHIN` bounds how far a value may be from what is certain, not from the start: a robot that is known to
    be far from the start is followed, since what holds it back would be a wrong model for ever.

    Args:
        interval: s between two times at least that they are handed on.
        start: the off-line model; None: the kinematic baseline.
    """

    def __init__(self, interval: float, start: Model | None) -> None:
        self._interval = interval
        self.start = values_of(start)
        self.values: dict[str, float] = dict(self.start)
        self.held: dict[str, str] = {}  # by parameter: what holds its value back
        self._handed: dict[str, float] = {}
        self._last = -math.inf  # s, when they were handed on
        self._then = -math.inf  # s, of the last step

    def step(self, t: float, model: Model | None, validity: Callable[[str], Validity]) -> None:
        """Move towards a valid model for the time since the last step; `t` is a stamp [s].

        Hours at a standstill, in which nothing is judged, count as 5 s: they are no reason for a jump.

        Args:
            t: now.
            model: what was learned; None while that is not valid: nothing moves then.
            validity: of each parameter by its name.
        """
        seconds = min(max(0.0, t - self._then), LONGEST_STEP) if math.isfinite(self._then) else 0.0
        self._then = t
        for name, wanted, prior in self._wanted(model, validity):
            most = RATE * prior * seconds
            now = self.values[name]
            self.values[name] = now + min(max(wanted - now, -most), most)

    def jump(self, model: Model, validity: Callable[[str], Validity]) -> None:
        """Take the learned model at once, clipped all the same: a request asked for it."""
        for name, wanted, _ in self._wanted(model, validity):
            self.values[name] = wanted

    def withdraw(self) -> bool:
        """Go back to the start at once; return whether others had anything else."""
        sent = math.isfinite(self._last)
        self.values, self._handed, self._last = dict(self.start), {}, -math.inf
        self.held.clear()
        return sent

    def due(self, t: float, model: Model) -> bool:
        """Say whether to send at `t` [s]: the interval is over, and something moved enough."""
        if t < self._last + self._interval:
            return False
        priors = {row.name: row.prior_std for row in model.vector.rows}
        return any(
            abs(value - self._handed.get(name, self.start.get(name, 0.0)))
            > THRESHOLD * priors.get(name, math.inf)
            for name, value in self.values.items()
        )

    def handed_on(self, t: float) -> None:
        """Remember what was sent at `t` [s]."""
        self._last, self._handed = t, dict(self.values)

    def model(self, learned: Model) -> Model:
        """Return the learned model with the applied values; its covariance holds how far they are."""
        table = learned.table
        values = np.array([self.values.get(p.name, p.value) for p in table.rows])
        apart = values - table.values
        return learned.with_table(table.moved(values, table.covariance + np.outer(apart, apart)))

    def _wanted(
        self, model: Model | None, validity: Callable[[str], Validity]
    ) -> list[tuple[str, float, float]]:
        """Name, clipped goal and prior sd of the parameters that may move; new ones get their start."""
        found = []
        for p in model.vector.rows if model is not None else ():
            start = self.start.setdefault(p.name, start_value(p))
            self.values.setdefault(p.name, start)
            self.held.pop(p.name, None)
            if validity(p.name) == "estimated":
                reach = self._reach(p, start)
                goal = min(max(p.value, start - reach), start + reach)
                found.append((p.name, goal, p.prior_std))
                if goal != p.value:
                    self.held[p.name] = self._why_held(p, goal, start)
        return found

    def _reach(self, p: Parameter, start: float) -> float:
        """How far from its start a parameter is followed."""
        certain = max(0.0, abs(p.value - start) - CERTAIN * p.std)
        return min(certain + WITHIN * p.prior_std, FARTHEST * p.prior_std)

    def _why_held(self, p: Parameter, goal: float, start: float) -> str:
        learned = " +- ".join(estimate_texts(p.value, p.std))
        return (
            f"{p.name} is held at {number_text(goal, 3)}: learned {learned} is farther from the start"
            f" {number_text(start, 3)} than what is certain and {WITHIN:g} prior standard deviation allow"
        )


def values_of(model: Model | None) -> dict[str, float]:
    """Return a model's parameters as the model file has them; none of no model."""
    return {} if model is None else {row.name: row.value for row in model.vector.rows}


def start_value(p: Parameter) -> float:
    """Return where a parameter begins that the start does not have, when it is seen first."""
    return p.value if p.name.startswith("log_") else 0.0


def without_slip(model: Model, why: str) -> Model:
    """Return the kinematic baseline of a robot as a model that is not good, since another was withdrawn.

    Args:
        model: that was withdrawn.
        why: a sentence.
    """
    nothing = {"dynamics": False, "delays": False, "lags": False, "clock_offset": False, "response": False}
    verdict = VerdictSection(good=False, sentence=f"No slip: what was learned was withdrawn. {why}")
    changed: dict[str, object] = {
        **nothing,
        "sensor_extrinsics": False,
        "slip": Slip(basis="none", lon=[], lat=[], ang=[]),
        "limit_gains": None,
        "body_force": None,
        "slip_disturbance": None,
        "weights": {},
        "surfaces": [],
        "verdict": verdict,
    }
    return model.with_table(model.table.of("car"), **changed)


def physical(name: str, values: Mapping[str, float]) -> float | None:
    """Return a value in its physical unit by the physical name; None where there is none."""
    if name in values:
        return values[name]
    logarithm = values.get(f"log_{name}")
    return None if logarithm is None else math.exp(logarithm)

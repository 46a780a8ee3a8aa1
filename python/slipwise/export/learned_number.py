# SPDX-License-Identifier: Apache-2.0
"""Numbers from what a model learned, which carry how sure they are, and which of them may be written."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise.models.limits import LearnedLimit
from slipwise.models.model import Model
from slipwise.models.parameter_table import known
from slipwise.models.schema import UNIDENTIFIABLE_RATIO
from slipwise.models.sensor_look import IfTurned, if_turned
from slipwise.number_text import estimate_texts

Floats = NDArray[np.float64]

_ROUNDING = 1e-9  # of a derivative; what is smaller is left of an inversion
_MATTERS = 0.01  # of a number, by which a sensor that may be turned has to change it


@dataclass(frozen=True, eq=False)
class LearnedNumber:
    """A number and its derivative by the model's parameters; arithmetic carries both along."""

    value: float
    by_parameter: Floats  # [parameters]
    own_variance: float = 0.0  # of what is not a parameter, such as a limit; taken as independent
    guessed: float = 0.0  # fraction of that variance that the log says nothing about

    def __add__(self, other: LearnedNumber) -> LearnedNumber:
        return self._joined(self.value + other.value, (1.0, 1.0), other)

    def __mul__(self, other: LearnedNumber | float) -> LearnedNumber:
        if not isinstance(other, LearnedNumber):
            return self._scaled(other)
        return self._joined(self.value * other.value, (other.value, self.value), other)

    def __truediv__(self, other: LearnedNumber) -> LearnedNumber:
        ratio = self.value / other.value
        return self._joined(ratio, (1.0 / other.value, -ratio / other.value), other)

    def arctan(self) -> LearnedNumber:
        """Return the angle [rad] whose tangent this is."""
        slope = 1.0 / (1.0 + self.value**2)
        variance = slope**2 * self.own_variance
        return LearnedNumber(math.atan(self.value), slope * self.by_parameter, variance, self.guessed)

    def _scaled(self, factor: float) -> LearnedNumber:
        variance = factor**2 * self.own_variance
        return LearnedNumber(factor * self.value, factor * self.by_parameter, variance, self.guessed)

    def _joined(self, value: float, slopes: tuple[float, float], other: LearnedNumber) -> LearnedNumber:
        mine, its = slopes
        parts = (mine**2 * self.own_variance, its**2 * other.own_variance)
        total = sum(parts)
        guessed = (parts[0] * self.guessed + parts[1] * other.guessed) / total if total > 0.0 else 0.0
        return LearnedNumber(value, mine * self.by_parameter + its * other.by_parameter, total, guessed)


class LearnedNumbers:
    """Makes the numbers of one model, and decides which of them a file for another tool may state."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._covariance = model.covariance
        self._prior = np.square(model.prior_std)
        guessed = np.array([not parameter.identifiable for parameter in model.vector.rows], dtype=bool)
        unlearned = np.where(guessed[:, None] | guessed, 0.0, model.covariance)
        self._unlearned = unlearned + np.diag(np.where(guessed, self._prior, 0.0))
        origin = model.content.provenance
        self._residuals = origin.learned_segments * (origin.residuals_per_segment or 1.0)
        self._names = [parameter.name for parameter in model.vector.rows]

    def exactly(self, value: float) -> LearnedNumber:
        """Return a number that is not learned."""
        return LearnedNumber(value, np.zeros(len(self._prior)))

    def of_parameters(self, value: float, by_parameter: Floats) -> LearnedNumber:
        """Return a number with its derivative by the first parameters, such as those of slip."""
        padded = np.zeros(len(self._prior))
        padded[: len(by_parameter)] = by_parameter
        return LearnedNumber(value, padded)

    def seconds(self, place: int, logarithm: float) -> LearnedNumber:
        """Return a time [s] of which the parameter at `place` is the logarithm."""
        value = math.exp(logarithm)
        by_parameter = np.zeros(len(self._prior))
        by_parameter[place] = value
        return LearnedNumber(value, by_parameter)

    def limit(self, limit: LearnedLimit) -> LearnedNumber:
        """Return a limit of the drive."""
        return LearnedNumber(limit.value, np.zeros(len(self._prior)), limit.std**2)

    def variance(self, value: float, *, guessed: float) -> LearnedNumber:
        """Return a learned variance: that of n residuals is known to a fraction of sqrt(2/n).

        Args:
            value: the variance, or what is in proportion to it.
            guessed: the fraction of it that the log says nothing about.
        """
        spread = 2.0 / self._residuals if self._residuals > 0 else math.inf
        own = value**2 * spread if value else 0.0
        return LearnedNumber(value, np.zeros(len(self._prior)), own, guessed)

    def std(self, number: LearnedNumber) -> float:
        """Return the number's standard deviation."""
        by = number.by_parameter
        return math.sqrt(max(0.0, float(by @ self._covariance @ by)) + number.own_variance)

    def objection(self, number: LearnedNumber) -> str:
        """Say why the number must not be written; empty where it may be.

        It may where it is known to the stated fraction, the log says more about it than the prior, and it is
        the same whether the robot slips sideways or its pose sensor is turned.
        """
        if not math.isfinite(number.value):
            return "what was learned gives no finite number"
        std = self.std(number)
        shown = self.text(number)
        if std > 0.0 and not known(number.value, std):
            return f"{shown} is too uncertain"
        if self._guessed_fraction(number) > UNIDENTIFIABLE_RATIO:
            return f"this log does not determine it: {shown} is about the initial guess"
        turned = self._if_turned
        change = 0.0 if turned is None else float(number.by_parameter[: len(turned.change)] @ turned.change)
        if turned is not None and abs(change) > max(std, _MATTERS * abs(number.value)):
            return (
                f"this log does not tell side slip from a turned pose sensor: {shown}, or"
                f" {number.value + change:.3g} if it is {turned.words}"
            )
        return ""

    @cached_property
    def _if_turned(self) -> IfTurned | None:
        return if_turned(self._model)

    def text(self, number: LearnedNumber) -> str:
        """Return the number with its standard deviation, such as `1.68 +- 0.02`."""
        return " +- ".join(estimate_texts(number.value, self.std(number)))

    def parameters_of(self, number: LearnedNumber) -> list[str]:
        """Return the names of the model's parameters that the number depends on."""
        return [
            name
            for name, by in zip(self._names, number.by_parameter.tolist(), strict=True)
            if abs(by) > _ROUNDING
        ]

    def _guessed_fraction(self, number: LearnedNumber) -> float:
        """What the log left of the variance before it: all that is of parameters it does not determine."""
        by = number.by_parameter
        before = float(np.square(by) @ self._prior)
        after = max(0.0, float(by @ self._unlearned @ by))
        fraction = after / before if before > 0.0 else 0.0
        return max(fraction, number.guessed)

# SPDX-License-Identifier: Apache-2.0
"""Rates that come out of inputs, fitted in windows: of the inputs in each and in its neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

TAPS = (-2, -1, 0, 1, 2)  # windows whose inputs act in a window: means are of either side, and stamps late
NOW = TAPS.index(0)
_AFTER = len(TAPS) - NOW  # columns from that on
BLOCKS = 10  # that are left out in turn
_ROUNDS = 20  # of Gauss-Newton
_LEAST_NOISE = 1e-6  # of the mean square
_UNEVEN = 0.02  # of the square of a speed, by which slip scatters


@dataclass(frozen=True, eq=False)
class Fit:
    """Rates that come out of inputs, in M windows."""

    inputs: Floats  # [M, taps] in the window and its neighbours
    outputs: Floats  # [M]
    parts: Ints  # [M] the tenth of the time

    def __len__(self) -> int:
        return len(self.outputs)

    def only(self, kept: NDArray[np.bool_]) -> Fit:
        """Return it with some of the windows alone."""
        return Fit(self.inputs[kept], self.outputs[kept], self.parts[kept])

    def without_oldest(self) -> Fit:
        """Return it without the oldest of the inputs that act."""
        return replace(self, inputs=self.inputs[:, 1:])

    def coefficients(self) -> Floats:
        """Return how much of each input comes out, [taps]."""
        return np.asarray(np.linalg.lstsq(self.inputs, self.outputs, rcond=None)[0], dtype=np.float64)

    def rates_out(self) -> Floats:
        """Return the rates that come out [M]."""
        return self.outputs

    def gain(self) -> float:
        """Return how much comes out in the end."""
        return float(self.coefficients().sum())

    def explained(self) -> float:
        """Return which part of the squares of the rates about their mean comes of the inputs."""
        rates = self.rates_out()
        left = np.square(rates - self.inputs @ self.coefficients()).sum()
        return float(1.0 - left / max(float(np.square(rates - rates.mean()).sum()), np.finfo(float).tiny))

    def scatter(self, number: Callable[[Fit], float]) -> float:
        """Return the standard deviation of a number, by leaving a tenth of the windows out in turn."""
        left = [number(self.only(self.parts != part)) for part in range(BLOCKS)]
        return float(np.sqrt((BLOCKS - 1) * np.var(left)))


@dataclass(frozen=True, eq=False)
class SquareFit(Fit):
    """Speeds that come out of inputs where positions alone tell them: `outputs` are squares of speeds.

    The square of a distance holds the noise of both positions as a constant, which is found beside the
    coefficients. A length would be too long by the noise, a length along a noisy direction too short.
    """

    beside: Floats  # [M] m/s, what the sensor goes more than the body since that turns
    adding: Floats  # [M, K] what adds to a square in some amount: squares of yaw rates and of sideways speeds

    def only(self, kept: NDArray[np.bool_]) -> SquareFit:
        """Return it with some of the windows alone."""
        arrays = (self.inputs, self.outputs, self.parts, self.beside, self.adding)
        return SquareFit(*(each[kept] for each in arrays))  # type: ignore[arg-type]

    def coefficients(self) -> Floats:
        """Return how much of each input comes out, [taps]."""
        inputs, size = self.inputs, np.sqrt(self.outputs)
        others: Floats = np.column_stack((np.ones(len(self)), self.adding))  # noise first
        start: Floats = np.sign(inputs[:, -_AFTER]) * size - self.beside
        acts = np.asarray(np.linalg.lstsq(inputs, start, rcond=None)[0], dtype=np.float64)
        adds = np.zeros(len(others.T))
        for _ in range(_ROUNDS):
            speed = inputs @ acts + self.beside
            weight = self._weights(speed)
            columns = np.column_stack((2.0 * speed[:, None] * inputs, others)) * weight[:, None]
            left = (self.outputs - np.square(speed) - others @ adds) * weight
            step = np.asarray(np.linalg.lstsq(columns, left, rcond=None)[0], dtype=np.float64)
            acts, adds = acts + step[: len(acts)], adds + step[len(acts) :]
        return acts

    def _weights(self, speed: Floats) -> Floats:
        """Return one over the deviations of squares, noise and slip together."""
        left = np.sqrt(np.abs(self.outputs - np.square(speed)))
        lengths = np.square(left) / np.maximum(np.maximum(np.abs(speed), left), np.finfo(float).tiny)
        noise = max(float(np.square(np.median(lengths))), _LEAST_NOISE * float(self.outputs.mean()))
        scatter = 2.0 * noise * np.square(speed) + noise**2 + (_UNEVEN * np.square(speed)) ** 2
        return 1.0 / np.sqrt(np.maximum(scatter, np.finfo(float).tiny))

    def rates_out(self) -> Floats:
        """Return the speeds [M], the noise of positions in them, to the side where inputs drive."""
        ahead: Floats = np.sign(self.inputs @ self.coefficients())
        return ahead * np.sqrt(self.outputs) - self.beside

# SPDX-License-Identifier: Apache-2.0
"""Names the surface while a robot drives, from samples of its IMU and motor currents as they come."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.terrain.classifier import TerrainClassifier


@dataclass(frozen=True)
class TerrainWindow:
    """What one window says."""

    start: float  # s
    end: float  # s
    probability: Mapping[str, float]  # of each surface, if it is one of those that were trained
    unknown: float  # that it is none of them, with even prior odds


class TerrainWatch:
    """Answers once a window is over; the core computes what `slipwise terrain classify` does."""

    def __init__(self, classifier: TerrainClassifier, *, step: float = 1.0) -> None:
        """Watch with a classifier.

        Args:
            classifier: as trained.
            step: from one window's start to the next [s].

        Raises:
            SettingsError: the step is not positive.
        """
        cutting = classifier.cutting
        rates = (cutting.seconds, cutting.imu_rate, cutting.drive_rate)
        try:
            self._core = _core.TerrainWatch(classifier.in_core, rates, step)
        except ValueError as problem:
            raise SettingsError(str(problem), where="step") from problem

    def push_imu(self, t: float, sample: Sequence[float]) -> None:
        """Take wx wy wz [rad/s] and ax ay az [m/s^2] at a stamp [s]; what is not finite is left out."""
        self._core.push_imu(t, list(sample))

    def push_currents(self, t: float, sample: Sequence[float]) -> None:
        """Take left and right current [A], left and right wheel speed [m/s] at a stamp [s]; the same."""
        self._core.push_drive(t, list(sample))

    @property
    def left_out(self) -> int:
        """Return how many samples were left out: not finite, or not going on in time."""
        return int(self._core.left_out)

    def answers(self) -> list[TerrainWindow]:
        """Return what windows said since the last call."""
        return [
            TerrainWindow(
                each.start,
                each.end,
                dict(zip(each.answer.classes, each.answer.probability.tolist(), strict=True)),
                each.answer.unknown,
            )
            for each in self._core.take_answers()
        ]

# SPDX-License-Identifier: Apache-2.0
"""Labels of the surface under the robot, and the surfaces that a learner remembers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise import _core
from slipwise.calibration.learned_sequence import SurfaceChange, SurfaceSummary, change_of, summary_of
from slipwise.calibration.surface_sections import begin_with
from slipwise.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from slipwise.models import Model


class RememberedSurfaces:
    """The part of a `MotionLearner` that is about surfaces."""

    _core: _core.MotionLearner
    _remember: bool
    _input: str
    _start: Model | None  # that it began with

    def begin_with(self, model: Model, *, wheels: bool = False, where: str = "") -> None:
        """Begin with a robot and its surfaces as a model file has them, before anything is pushed.

        Args:
            model: of the same input, learned with a memory of surfaces.
            wheels: whether wheel speeds will come beside the commands.
            where: the model's file, for errors.

        Raises:
            ModelError: the model has another input, or no memory of surfaces.
            SettingsError: something was pushed already, or the model was learned with other bases.
        """
        begin_with(self._core, model, self._input, wheels=wheels, where=where)
        self._start = model

    def cue_surface(self, label: str = "") -> None:
        """Say that the surface changes now: to the one of this name, or to another where it is empty.

        A learner that remembers no surfaces makes nothing of a name; without one it gives slip a tenth of its
        prior variance back, as where it suspects a change itself.
        """
        self._core.cue_surface(label)

    def cue_terrain(self, probability: Mapping[str, float], *, unknown: float = 0.0) -> None:
        """Take what a sensor says of the terrain under the robot now, such as `TerrainWatch.answers`.

        Classes may have any names: on which surface each is said is learned. Where nothing remembers
        surfaces, it says nothing.

        Args:
            probability: of each class that the sensor knows, were the terrain one of them; adds up to 1.
            unknown: that it is none of them, with even prior odds.

        Raises:
            SettingsError: these are no probabilities.
        """
        odds = np.array(list(probability.values()), dtype=np.float64)
        try:
            self._core.cue_terrain(_core.TerrainAnswer(list(probability), odds, unknown))
        except (ValueError, TypeError) as problem:
            raise SettingsError(str(problem).splitlines()[0], where="cue_terrain") from problem

    def surfaces(self) -> tuple[SurfaceSummary, ...]:
        """Return the surfaces that are remembered, the present one as it is known now."""
        return tuple(summary_of(surface) for surface in self._core.surfaces().surfaces)

    @property
    def remembers(self) -> bool:
        """Whether surfaces are remembered."""
        return self._remember

    def probable_surfaces(self) -> tuple[tuple[str, float], ...]:
        """Return the surfaces that may be under the robot, each with its probability.

        The name is empty where a surface has none yet: it gets one when it is left. Nothing is returned where
        no surfaces are remembered.
        """
        return tuple((each.name, each.probability) for each in self._core.probable_surfaces())

    def surface_changes(self) -> tuple[SurfaceChange, ...]:
        """Return what happened to the surfaces since the last call; runs are counted as they were begun."""
        return tuple(change_of(event, event.run) for event in self._core.surface_events())

    def label_counts(self) -> tuple[float, float]:
        """Return how many labels were judged by what was driven, and how many of them were right."""
        judged, right = self._core.surfaces().labels
        return judged, right

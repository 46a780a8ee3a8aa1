# SPDX-License-Identifier: Apache-2.0
"""What a calibration returns: the model, the verdict, and how the parameters came about."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.identifiability import LookAlike
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.smoothing import SmoothedCourse
from slipwise.logs.log import LeftOut
from slipwise.models.model import Model

Floats = NDArray[np.float64]

COMPANION = "iekf"  # the filter that runs along an estimator that fits all windows at once, and is judged


@dataclass(frozen=True)
class Verdict:
    """Whether the model may be used, in words."""

    good: bool
    sentence: str
    undetermined: tuple[str, ...] = ()  # parameters that the log does not determine
    advice: tuple[str, ...] = ()  # what would determine them, and tell look-alikes apart
    look_alikes: tuple[LookAlike, ...] = ()  # pairs of parameters that the log can hardly tell apart
    timing: str = ""  # which delay and which clock offset is which
    reservations: tuple[str, ...] = ()  # sentences of a good verdict that qualify it: it is not plainly good
    contradictions: tuple[str, ...] = ()  # between poses and inputs: what was learned is no slip

    def __str__(self) -> str:
        return " ".join((self.sentence, *self.advice))


@dataclass(frozen=True, eq=False)
class History:
    """The causal run of the filter, one row per learned window, in the order learned."""

    run: NDArray[np.int64]  # [W] index of the run in the log
    t: Floats  # [W] s, the end of the window: everything in this row was known then
    names: tuple[str, ...]  # [P] parameter names
    mean: Floats  # [W, P] parameters after the window
    std: Floats  # [W, P] their standard deviations
    nis: Floats  # [W] normalised innovation squared of the window before it was learned, 3 degrees of freedom
    weight: Floats  # [W] how much the window counted: 1 full, 0 left out
    bases: tuple[str, ...]  # [B] bases averaged, one where the basis is fixed
    basis_weight: Floats  # [W, B] their weights after the window
    change: Floats  # [W] log odds, before the window was learned, that the ground had changed; 0 or more
    alarm: NDArray[np.bool_]  # [W] whether that was taken for a change of ground
    structures: tuple[str, ...] = ()  # [S] ways to learn from commands, where more than one was tried
    structure_weight: Floats | None = None  # [W, S] their weights after the window

    def alarms(self) -> tuple[tuple[int, float], ...]:
        """Return (run, time [s]) of every alarm: the end of the window that raised it."""
        at = np.flatnonzero(self.alarm)
        return tuple((int(self.run[i]), float(self.t[i])) for i in at)


@dataclass(frozen=True, eq=False)
class Calibration:
    """The result of `slipwise.calibrate`."""

    model: Model
    verdict: Verdict
    history: History | None  # None for a batch fit
    left_out: tuple[LeftOut, ...]  # of the log and of the segmentation
    notes: tuple[str, ...]
    smoothed: SmoothedCourse | None = None  # where it was asked for

    @property
    def method(self) -> str:
        """The name that an evaluation has for what was judged: a basis, or an estimator."""
        settings = self.model.content.provenance.settings
        estimator = str(settings.get("estimator", AVERAGE))
        if estimator == AVERAGE:
            return str(settings.get("basis", Settings().basis))
        return COMPANION if self.history is None else estimator

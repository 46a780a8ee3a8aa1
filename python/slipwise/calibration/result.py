# SPDX-License-Identifier: Apache-2.0
"""What a calibration returns: the model, the verdict, and how the parameters came about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.calibration.identifiability import Confounded
from slipwise.calibration.mounts import Mount
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.smoothing import SmoothedCourse
from slipwise.calibration.surface_course import SurfaceCourse
from slipwise.frames import data_frame
from slipwise.logs.log import LeftOut
from slipwise.models.model import Model

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

COMPANION = "iekf"  # the filter that runs along an estimator that fits all windows at once, and is judged


@dataclass(frozen=True)
class Verdict:
    """Whether the model may be used, in words."""

    good: bool
    sentence: str
    not_identifiable: tuple[str, ...] = ()  # parameters that the log does not determine
    advice: tuple[str, ...] = ()  # what would determine them, and tell confounded parameters apart
    confounded: tuple[Confounded, ...] = ()  # pairs of parameters that the log can hardly tell apart
    timing: str = ""  # which delay and which clock offset is which
    reservations: tuple[str, ...] = ()  # sentences of a good verdict that qualify it: it is not plainly good
    force: str = ""  # what pushes the robot beside its slip, where that was learned
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
    change: Floats  # [W] log odds, before the window was learned, that the terrain had changed; 0 or more
    alarm: NDArray[np.bool_]  # [W] whether that counted as a change of terrain
    structures: tuple[str, ...] = ()  # [S] ways to learn from commands, where more than one was tried
    structure_weight: Floats | None = None  # [W, S] their weights after the window
    surfaces: SurfaceCourse | None = None  # where surfaces are remembered

    def __repr__(self) -> str:
        return f"<History: {len(self.t)} windows of {len(self.names)} parameters, {self.alarm.sum()} alarms>"

    def to_dataframe(self) -> pd.DataFrame:
        """Return one row a window: run, t, each parameter with its std, nis, weight, change and weights.

        Parameters are as the filter has them, lags and delays as logarithms. Weights of bases stand under
        `basis:NAME`, those of ways to learn from commands under `structure:NAME`.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        columns: dict[str, ArrayLike] = {"run": self.run, "t": self.t}
        for k, name in enumerate(self.names):
            columns |= {name: self.mean[:, k], f"std({name})": self.std[:, k]}
        columns |= {"nis": self.nis, "weight": self.weight, "change": self.change, "alarm": self.alarm}
        columns |= {f"basis:{name}": self.basis_weight[:, k] for k, name in enumerate(self.bases)}
        if self.structure_weight is not None:
            weights = self.structure_weight
            columns |= {f"structure:{name}": weights[:, k] for k, name in enumerate(self.structures)}
        return data_frame(columns)

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
    predictions: tuple[Predictions, ...] = ()  # those judged, of each horizon; what `evaluate` makes again
    baseline: tuple[Predictions, ...] = ()  # of the kinematic baseline over the same stretches
    mounts: tuple[Mount, ...] = ()  # of sources of poses beside the first
    other: Calibration | None = None  # from wheel speeds, where the model answers from both inputs

    def __repr__(self) -> str:
        state = "good" if self.verdict.good else "not good enough"
        return f"<Calibration: {state}. {self.model!r}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the model with its verdict."""
        return self.model._repr_html_()

    def to_dataframe(self) -> pd.DataFrame:
        """Return the model's parameters in physical units as a pandas data frame, one a row.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        return self.model.to_dataframe()

    @property
    def method(self) -> str:
        """The name that an evaluation has for what was judged: a basis, or an estimator."""
        settings = self.model.content.provenance.settings
        estimator = str(settings.get("estimator", AVERAGE))
        if estimator == AVERAGE:
            return str(settings.get("basis", Settings().basis))
        return COMPANION if self.history is None else estimator

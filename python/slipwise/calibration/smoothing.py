# SPDX-License-Identifier: Apache-2.0
"""Slip that changes slowly: what its parameters were during each window, given the whole log."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.settings import Settings
from slipwise.files import write_text_whole
from slipwise.frames import data_frame

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SmoothedCourse:
    """The slip parameters over a log, one row per window; off-line, so never for predictions."""

    run: NDArray[np.int64]  # [W] index of the run in the log
    start: Floats  # [W] s
    end: Floats  # [W] s
    names: tuple[str, ...]  # [P] names of the slip parameters
    mean: Floats  # [W, P] parameters during the window
    std: Floats  # [W, P] their standard deviations

    def __repr__(self) -> str:
        return f"<SmoothedCourse: {len(self.end)} windows of {', '.join(self.names)}>"

    @property
    def t(self) -> Floats:
        """When each window was half over, [W] s."""
        return (self.start + self.end) / 2.0

    def save(self, path: Path) -> Path:
        """Write a CSV: run, t_start, t_end, then each parameter and its standard deviation; return the path.

        Raises:
            OutputError: the file cannot be written.
        """
        columns = self._columns()
        lines = [",".join(columns)]
        for run, *numbers in zip(*columns.values(), strict=True):
            lines.append(",".join((str(run), *(repr(float(number)) for number in numbers))))
        write_text_whole(path, "\n".join(lines) + "\n")
        return path

    def to_dataframe(self) -> pd.DataFrame:
        """Return the columns that `save` writes as a pandas data frame.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        return data_frame(self._columns())

    def _columns(self) -> dict[str, NDArray[Any]]:
        columns: dict[str, NDArray[Any]] = {"run": self.run, "t_start": self.start, "t_end": self.end}
        for k, name in enumerate(self.names):
            columns |= {name: self.mean[:, k], f"std({name})": self.std[:, k]}
        return columns


def smooth(posterior: Posterior, windows: WindowSet, settings: Settings) -> SmoothedCourse:
    """Smooth over all windows: forward filter, backward pass of Rauch, Tung and Striebel (1965).

    Lag, delay and clock offset are the robot's, not the terrain's: they are taken as learned.

    Args:
        posterior: what was learned: its model, its prior of the slip, its actuator and its noise are used.
        windows: what was learned; they must not overlap.
        settings: how fast the slip may change, the shape of the noise, and the filter.
    """
    motion, filters = posterior.motion, settings.filter_settings()
    slip = slice(motion.slip_size)
    histories = [windows.input_history(i) for i in range(len(windows))]
    noise = [_noise(posterior, filters.noise.shape, windows, i) for i in range(len(windows))]
    drift = settings.smoothing.drift_settings()
    course = _core.rts_smooth(
        motion, _prior(posterior), histories, list(windows.segments), noise, drift, filters.iekf
    )
    return SmoothedCourse(
        run=np.array([windows.drive[p].index for p in windows.position], dtype=np.int64),
        start=windows.start,
        end=windows.end,
        names=tuple(info.name for info in motion.parameters[slip]),
        mean=np.array([estimate.mean[slip] for estimate in course]),
        std=np.array([np.sqrt(np.diag(estimate.covariance)[slip]) for estimate in course]),
    )


def _prior(posterior: Posterior) -> _core.Estimate:
    """The slip as before any data, the actuator as learned."""
    slip = slice(posterior.motion.slip_size)
    mean, covariance = posterior.mean.copy(), posterior.covariance.copy()
    mean[slip] = 0.0
    covariance[slip, :] = covariance[:, slip] = 0.0
    covariance[slip, slip] = np.diag(posterior.prior_std[slip] ** 2)
    return _core.Estimate(mean, np.asfortranarray(covariance))


def _noise(posterior: Posterior, shape: _core.MotionNoise, windows: WindowSet, i: int) -> Floats:
    """Covariance of what was measured of window i, a row for each number."""
    segment = windows.segments[i]
    path = _core.integrate_segment(
        posterior.motion, posterior.mean, windows.input_history(i), segment, _core.Integrator.Exact
    )
    return np.asfortranarray(_core.segment_noise(path, segment, shape, posterior.noise_scale))

# SPDX-License-Identifier: Apache-2.0
"""Cuts recordings into windows of some seconds and describes each by numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError
from slipwise.terrain.features import CURRENT_FEATURES, current_features, vibration_features, vibration_names
from slipwise.terrain.recordings import Floats, Recording, Stream

SAME_RATE = 1.25  # rates that differ by less are one


@dataclass(frozen=True)
class Cutting:
    """How windows are cut; rates are those of the training logs, to which others are interpolated."""

    seconds: float
    imu_rate: float  # Hz, 0 where there was no IMU
    drive_rate: float  # Hz, 0 where there were no currents


@dataclass(frozen=True)
class Windows:
    """Windows of several runs; a row of NaN where a window has no such measurement."""

    run: NDArray[np.object_]  # [N]
    start: Floats  # [N] s
    end: Floats  # [N] s
    label: NDArray[np.object_]  # [N] empty where the surface is not known, or changes
    vibration: Floats  # [N, V]
    current: Floats  # [N, C]

    def __len__(self) -> int:
        return len(self.run)

    @property
    def has_vibration(self) -> NDArray[np.bool_]:
        """Return which windows have IMU measurements, [N]."""
        return _measured(self.vibration)

    @property
    def has_current(self) -> NDArray[np.bool_]:
        """Return which windows have currents, [N]."""
        return _measured(self.current)

    def only(self, chosen: NDArray[np.bool_]) -> Windows:
        """Return the windows that are chosen, [N]."""
        return Windows(*(getattr(self, column.name)[chosen] for column in fields(self)))


def _measured(features: Floats) -> NDArray[np.bool_]:
    """Return which rows hold numbers, [N]; none where there are no features, since there was no sensor."""
    return np.asarray(np.isfinite(features).all(axis=1) & (features.shape[1] > 0))


def cutting_of(recordings: Sequence[Recording], seconds: float) -> Cutting:
    """Return windows of `seconds` at the median rates of the recordings."""
    imu = [_rate(recording.imu) for recording in recordings if recording.imu is not None]
    drive = [_rate(recording.drive) for recording in recordings if recording.drive is not None]
    return Cutting(seconds, float(np.median(imu)) if imu else 0.0, float(np.median(drive)) if drive else 0.0)


def cut_windows(
    recordings: Sequence[Recording],
    cutting: Cutting,
    *,
    step: float,
    progress: Callable[[float], None] = lambda _share: None,
) -> Windows:
    """Cut windows that start every `step` seconds of each run.

    Raises:
        LogError: an IMU or currents were sampled at another rate than the training logs' were.
    """
    rows: list[tuple[str, float, str, Floats, Floats]] = []
    for k, recording in enumerate(recordings):
        _refuse_other_rate(recording.imu, cutting.imu_rate, recording.run, "IMU")
        _refuse_other_rate(recording.drive, cutting.drive_rate, recording.run, "motor current")
        first, last = recording.span
        for start in np.arange(first, last - cutting.seconds + step / 2 + 1e-9, step).tolist():
            vibration, current = _described(recording, start, cutting)
            if np.isfinite(vibration).all() or np.isfinite(current).all():
                label = recording.label(start, start + cutting.seconds)
                rows.append((recording.run, start, label, vibration, current))
        progress((k + 1) / len(recordings))
    starts = np.array([row[1] for row in rows], dtype=np.float64)
    empty = len(vibration_names(cutting.imu_rate)), len(CURRENT_FEATURES)
    return Windows(
        np.array([row[0] for row in rows], dtype=object),
        starts,
        starts + cutting.seconds,
        np.array([row[2] for row in rows], dtype=object),
        np.array([row[3] for row in rows]).reshape(len(rows), empty[0]),
        np.array([row[4] for row in rows]).reshape(len(rows), empty[1]),
    )


def _described(recording: Recording, start: float, cutting: Cutting) -> tuple[Floats, Floats]:
    vibration = np.full(len(vibration_names(cutting.imu_rate)), np.nan)
    current = np.full(len(CURRENT_FEATURES), np.nan)
    imu = _on_grid(recording.imu, start, cutting.seconds, cutting.imu_rate)
    drive = _on_grid(recording.drive, start, cutting.seconds, cutting.drive_rate)
    if imu is not None:
        vibration = vibration_features(imu, cutting.imu_rate)
    if drive is not None:
        current = current_features(drive)
    return vibration, current


def _on_grid(stream: Stream | None, start: float, seconds: float, rate: float) -> Floats | None:
    """Return the stream at `rate` from `start` on [n, D]; None where samples are missing."""
    if stream is None or rate <= 0.0:
        return None
    return _core.even_samples(stream.t, stream.values, start, (seconds, rate))


def _rate(stream: Stream) -> float:
    return float(1.0 / np.median(np.diff(stream.t)))


def _refuse_other_rate(stream: Stream | None, rate: float, run: str, what: str) -> None:
    if stream is None or rate <= 0.0:
        return
    own = _rate(stream)
    if not rate / SAME_RATE < own < rate * SAME_RATE:
        raise LogError(
            f"the {what} was sampled at {own:.3g} Hz, in training at {rate:.3g} Hz",
            where=f"run {run}",
            advice="resample it, or train with logs of this rate",
        )

# SPDX-License-Identifier: Apache-2.0
"""What a watcher remembers of the outputs: the newest of each, the fused path and the last NIS."""

from __future__ import annotations

import math
import threading
from collections import deque
from dataclasses import dataclass

from slipwise.live.outputs import NextMovesNow, Note, Odometry, Output, Path, Status

MOST_FUSED = 600  # points of the fused path
MOST_NIS = 240
MOST_NOTES = 12
_FUSED_STEP = 0.03  # m between two of its points
_SENSOR_JUMP = 5.0  # m between two of its points from which on it begins again


@dataclass(frozen=True)
class Seen:
    """All that there is to show."""

    count: int  # of statuses so far: changes show by it
    status: Status | None
    predicted: Path | None
    odometry: Odometry | None
    fused: tuple[tuple[float, float], ...]  # x, y [m], oldest first
    nis: tuple[tuple[int, float], ...]  # which segment, its NIS; oldest first. Clocks may jump, counts do not
    notes: tuple[tuple[float, str], ...]  # stamp [s], text, newest first
    next_moves: NextMovesNow | None = None


class History:
    """Takes outputs from one thread and shows them to others."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._status: Status | None = None
        self._predicted: Path | None = None
        self._odometry: Odometry | None = None
        self._fused: deque[tuple[float, float]] = deque(maxlen=MOST_FUSED)
        self._next_moves: NextMovesNow | None = None
        self._frame = ""
        self._nis: deque[tuple[int, float]] = deque(maxlen=MOST_NIS)
        self._segments = 0
        self._notes: deque[tuple[float, str]] = deque(maxlen=MOST_NOTES)
        self._count = 0

    def take(self, output: Output) -> None:
        """Remember an output."""
        with self._lock:
            match output:
                case Status():
                    self._take_status(output)
                case Odometry():
                    self._odometry = output
                    self._take_fused(output)
                case Path():
                    if not output.asked:
                        self._predicted = output
                case NextMovesNow():
                    self._next_moves = output
                case Note():
                    self._notes.append((output.t, output.text))

    def seen(self) -> Seen:
        """Return what there is to show now."""
        with self._lock:
            status = self._status
            said = status.log[-MOST_NOTES:] if status is not None and status.log else tuple(self._notes)
            return Seen(
                count=self._count,
                status=status,
                predicted=self._predicted if status is None else status.predicted,
                odometry=self._odometry if status is None else status.odometry,
                fused=tuple(self._fused),
                nis=tuple(self._nis),
                notes=tuple(reversed(said)),
                next_moves=self._next_moves,
            )

    @property
    def count(self) -> int:
        """How many statuses were taken."""
        return self._count

    def _take_status(self, status: Status) -> None:
        self._status = status
        self._count += 1
        if status.segments < self._segments:  # another learner
            self._nis.clear()
        if status.segments != self._segments and status.nis is not None and math.isfinite(status.nis):
            self._nis.append((status.segments, status.nis))
        self._segments = status.segments

    def _take_fused(self, odometry: Odometry) -> None:
        x, y = odometry.pose[:2].tolist()
        if not (math.isfinite(x) and math.isfinite(y)):
            return
        if self._fused:
            step = math.dist((x, y), self._fused[-1])
            if odometry.frame == self._frame and step < _FUSED_STEP:
                return
            if odometry.frame != self._frame or step > _SENSOR_JUMP:
                self._fused.clear()
        self._frame = odometry.frame
        self._fused.append((x, y))

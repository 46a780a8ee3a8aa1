# SPDX-License-Identifier: Apache-2.0
"""A log as a transport: its samples in the order of their stamps, as fast as is asked for."""

from __future__ import annotations

import heapq
import time
from collections import deque
from collections.abc import Iterator, Sequence

from slipwise.calibration.prepared_run import PreparedRun, has_wheels, prepare_run
from slipwise.calibration.surface_labels import date_of, label_at_start, labels_of
from slipwise.errors import SettingsError
from slipwise.live.feed import Feed
from slipwise.live.samples import (
    Command,
    DriveStart,
    KnownForce,
    Pose,
    Reading,
    RunStart,
    Sample,
    Stamped,
    SurfaceCue,
    Wheels,
)
from slipwise.logs import Log
from slipwise.logs.fixes import FIXES
from slipwise.segments import force_rows, reading_rows, recording_rows, source_names, sourced_rows

AS_FAST_AS_IT_GOES = 0.0


class Replay(Feed):
    """Delivers what `calibrate` would learn from, run after run.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel".
        rate: times real time; 0 for as fast as it goes.
        label: name of the surface; without it those of the column `terrain`.

    Raises:
        LogError: no run has such inputs and poses.
        SettingsError: the rate is negative.
    """

    def __init__(self, log: Log, input_name: str, *, rate: float = 1.0, label: str | None = None) -> None:
        if not rate >= AS_FAST_AS_IT_GOES:
            raise SettingsError(f"the rate is {rate:g}", where="--rate", advice="such as 10, or 0: no waits")
        drive = prepare_run(log, input_name)
        super().__init__(self._paced(drive, rate, label))
        self._wheels, self._clocks_compared = has_wheels(drive), log.clocks_compared
        self._sources = source_names(run.run for run in drive)

    @property
    def wheels(self) -> bool:
        """Whether some run has them."""
        return self._wheels

    @property
    def clocks_compared(self) -> bool:
        """As the log says."""
        return self._clocks_compared

    def _paced(self, drive: tuple[PreparedRun, ...], rate: float, label: str | None) -> Iterator[Sample]:
        for place, run in enumerate(drive):
            cues = labels_of(run.run) if label is None else ()
            begins = None
            if place == 0:
                begins = DriveStart(label or label_at_start(cues, run.run), date_of(drive))
            yield RunStart(run.run.name, begins)
            begin = time.monotonic()
            for sample in with_labels(samples_of(run, self._sources), cues):
                if isinstance(sample, SurfaceCue):
                    yield sample
                    continue
                if rate > 0.0:
                    due = begin + (sample.t - run.run.span[0]) / rate
                    self._stopped.wait(max(0.0, due - time.monotonic()))
                yield sample


def with_labels(
    samples: Iterator[Stamped], cues: Sequence[tuple[float, str]]
) -> Iterator[Stamped | SurfaceCue]:
    """Yield the samples, with each label before the first one that is not older."""
    waiting = deque(cues)
    for sample in samples:
        while waiting and waiting[0][0] <= sample.t:
            yield SurfaceCue(waiting.popleft()[1])
        yield sample


def samples_of(run: PreparedRun, sources: Sequence[str] = ()) -> Iterator[Stamped]:
    """Yield the samples of a run in the order of their stamps: commands, wheels, forces, poses, readings.

    Args:
        run: what was measured.
        sources: names of the sources of poses, where they are distinguished.
    """
    *others, measured = recording_rows(run.run)
    commands, wheels, attitudes = (rows.tolist() for rows in others)
    poses = (sourced_rows(run.run, measured, sources) if sources else measured).tolist()
    given = run.run.commands
    ends = [] if given is None else given.ends.tolist()
    tilt = {t: (roll, pitch) for t, roll, pitch in attitudes}
    seen = run.run.poses
    heights = {} if seen.z is None else dict(zip(seen.t.tolist(), seen.z.tolist(), strict=True))
    streams: tuple[list[tuple[float, int, int, Sample]], ...] = (
        [(t, 0, i, Command(t, v, omega, vy, ended=ends[i])) for i, (t, v, vy, omega) in enumerate(commands)],
        [(t, 1, i, Wheels(t, v, omega, vy)) for i, (t, v, vy, omega) in enumerate(wheels)],
        [(t, 2, i, KnownForce(t, x, y)) for i, (t, x, y) in enumerate(force_rows(run.run).tolist())],
        [
            (row[0], 3, i, _pose(row, tilt.get(row[0]), heights.get(row[0]), sources))
            for i, row in enumerate(poses)
        ],
        *_readings(run),
    )
    for _, _, _, sample in heapq.merge(*streams):
        assert isinstance(sample, Stamped)
        yield sample


def _readings(run: PreparedRun) -> list[list[tuple[float, int, int, Sample]]]:
    return [
        [(t, kind, i, Reading(t, column, value)) for i, (t, value) in enumerate(rows.tolist())]
        for kind, (column, rows) in enumerate(reading_rows(run.run).items(), start=4)
    ]


def _pose(
    row: list[float], tilt: tuple[float, float] | None, z: float | None, sources: Sequence[str]
) -> Pose:
    t, x, y, yaw, frame, std_xy, std_yaw, *sort = row
    number, fix = (int(each) for each in sort or (0, 0))
    roll, pitch, z = (*(tilt or (None, None)), z) if number == 0 else (None, None, None)
    std = (std_xy or None, std_yaw or None)
    source = sources[number] if number else ""
    return Pose(t, x, y, yaw, *std, str(int(frame)), roll, pitch, source, FIXES[fix], z)

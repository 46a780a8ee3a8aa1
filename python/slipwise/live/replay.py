# SPDX-License-Identifier: Apache-2.0
"""A log as a transport: its samples in the order of their stamps, as fast as is asked for."""

from __future__ import annotations

import heapq
import threading
import time
from collections.abc import Iterator

from slipwise.calibration.prepared_run import PreparedRun, prepare_run
from slipwise.errors import SettingsError
from slipwise.live.outputs import Output
from slipwise.live.samples import Command, Pose, RunStart, Sample, Wheels
from slipwise.live.transport import OnSample
from slipwise.logs import Log
from slipwise.segments import recording_rows

AS_FAST_AS_IT_GOES = 0.0


class Replay:
    """Delivers what `calibrate` would learn from, run after run.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel".
        rate: times real time; 0 for as fast as it goes.

    Raises:
        LogError: no run has such inputs and poses.
        SettingsError: the rate is negative.
    """

    def __init__(self, log: Log, input_name: str, *, rate: float = 1.0) -> None:
        if not rate >= AS_FAST_AS_IT_GOES:
            raise SettingsError(
                f"the rate is {rate:g}", where="--rate", advice="such as 10, or 0 for no wait"
            )
        self._drive, self._rate = prepare_run(log, input_name), rate
        self._stopped, self._done = threading.Event(), threading.Event()
        self._thread: threading.Thread | None = None

    def subscribe(self, on_sample: OnSample) -> None:
        """Begin to deliver."""
        self._thread = threading.Thread(target=self._deliver, args=(on_sample,), name="replay", daemon=True)
        self._thread.start()

    def publish(self, output: Output) -> None:
        """Nobody listens."""

    def notices(self) -> list[str]:
        """Nothing to say."""
        return []

    @property
    def finished(self) -> bool:
        """Whether the log is at its end."""
        return self._done.is_set()

    def close(self) -> None:
        """Stop where it is."""
        self._stopped.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)

    def _deliver(self, on_sample: OnSample) -> None:
        for run in self._drive:
            on_sample(RunStart(run.run.name))
            begin = time.monotonic()
            for sample in samples_of(run):
                if self._rate > 0.0:
                    due = begin + (sample.t - run.run.span[0]) / self._rate
                    self._stopped.wait(max(0.0, due - time.monotonic()))
                if self._stopped.is_set():
                    return
                on_sample(sample)
        self._done.set()


def samples_of(run: PreparedRun) -> Iterator[Command | Wheels | Pose]:
    """Yield the samples of a run in the order of their stamps; at one stamp commands first, poses last."""
    commands, wheels, attitudes, poses = (rows.tolist() for rows in recording_rows(run.run))
    tilt = {t: (roll, pitch) for t, roll, pitch in attitudes}
    streams: tuple[list[tuple[float, int, int, Sample]], ...] = (
        [(t, 0, i, Command(t, v, omega, vy)) for i, (t, v, vy, omega) in enumerate(commands)],
        [(t, 1, i, Wheels(t, v, omega, vy)) for i, (t, v, vy, omega) in enumerate(wheels)],
        [(row[0], 2, i, _pose(row, tilt.get(row[0]))) for i, row in enumerate(poses)],
    )
    for _, _, _, sample in heapq.merge(*streams):
        assert isinstance(sample, Command | Wheels | Pose)
        yield sample


def _pose(row: list[float], tilt: tuple[float, float] | None) -> Pose:
    t, x, y, yaw, frame, std_xy, std_yaw = row
    roll, pitch = tilt or (None, None)
    return Pose(t, x, y, yaw, std_xy or None, std_yaw or None, str(int(frame)), roll, pitch)

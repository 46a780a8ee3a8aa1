# SPDX-License-Identifier: Apache-2.0
"""Which robots of the real logs look stuck: every log pushed row by row, every alarm of the motion monitor.

Beside each alarm stands what the inputs asked for and what the poses say, from 0.6 s before it until it
went: a robot that did not do a fifth of what it was told was stuck indeed, whatever held it.

    python benchmarks/stuck.py --only warthog
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from data_sets import DataSet, data_sets, input_names, required_folder
from numpy.typing import NDArray

import slipwise
from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import Settings
from slipwise.cli.output import Column, Output
from slipwise.cli.progress import progress_bar
from slipwise.logs.log import Log, Run
from slipwise.segments import recording_rows

Floats = NDArray[np.float64]

WINDOW = 0.6  # s over which the monitor looks
STUCK = 0.2  # of what was asked for


@dataclass(frozen=True)
class Alarm:
    """One alarm: a span of time, and what was asked and done in it."""

    log: str
    input: str
    run: int
    begin: float  # s after the run's first pose
    end: float  # s; the run's last pose where it never went
    asked: tuple[float, float]  # m and rad that the inputs say
    done: tuple[float, float]  # m and rad from the first pose of the span to its last

    @property
    def still(self) -> bool:
        """Whether the robot did less than a fifth of what it was told."""
        parts = [done / asked for asked, done in zip(self.asked, self.done, strict=True) if asked > 0.1]
        return bool(parts) and max(parts) < STUCK

    def row(self) -> tuple[str, ...]:
        """Return the figures of a line of the table."""
        return (
            *(self.log, self.input, str(self.run), f"{self.begin:.1f}", f"{self.end - self.begin:.1f}"),
            *(f"{asked:.2f}" for asked in self.asked),
            *(f"{done:.2f}" for done in self.done),
            "yes" if self.still else "no",
        )


@dataclass(frozen=True)
class Watched:
    """One log from one input."""

    log: str
    input: str
    minutes: float
    judged: float  # fraction of the poses at which a fraction of the expected motion was known
    alarms: tuple[Alarm, ...]


LOG_COLUMNS = (
    Column("log"),
    Column("input"),
    Column("minutes", True),
    Column("judged %", True),
    Column("alarms", True),
)
ALARM_COLUMNS = (
    Column("log"),
    Column("input"),
    Column("run", True),
    Column("from s", True),
    Column("for s", True),
    Column("asked m", True),
    Column("rad", True),
    Column("done m", True),
    Column("rad", True),
    Column("still"),
)


def asked_of(inputs: Floats, begin: float, end: float) -> tuple[float, float]:
    """Return the path [m] and the angle [rad] that rows of (t, v, vy, omega), each held, say in a span."""
    t = np.clip(inputs[:, 0], begin, end)
    held = np.diff(t, append=end)
    return float(np.hypot(inputs[:, 1], inputs[:, 2]) @ held), float(np.abs(inputs[:, 3]) @ held)


def done_of(poses: Floats, begin: float, end: float) -> tuple[float, float]:
    """Return the distance [m] and the angle [rad] between the first and the last pose of a span."""
    inside = poses[(poses[:, 0] >= begin) & (poses[:, 0] <= end)]
    if len(inside) < 2:
        return 0.0, 0.0
    first, last = inside[0], inside[-1]
    return float(np.hypot(*(last - first)[1:3])), abs(_core.wrap_angle(float((last - first)[3])))


def alarms_of(learner: _core.MotionLearner, run: Run) -> tuple[list[tuple[float, float]], int, int]:
    """Push a run; return the spans of the alarms [s], and how many poses were judged of how many."""
    push = {
        0: lambda row: learner.push_command(row[0], row[1], row[3], row[2]),
        1: lambda row: learner.push_wheels(row[0], row[1], row[3], row[2]),
        2: lambda row: learner.push_attitude(*row),
        3: lambda row: learner.push_pose(*row[:4], int(row[4]), *row[5:7]),
    }
    rows = [(row[0], kind, row.tolist()) for kind, rows in enumerate(recording_rows(run)) for row in rows]
    spans: list[tuple[float, float]] = []
    since: float | None = None
    judged = poses = 0
    learner.start_run()
    for t, kind, row in sorted(rows, key=lambda row: (row[0], row[1])):
        push[kind](row)
        if kind != 3:
            continue
        state = learner.motion_monitor()
        poses += 1
        judged += state.fraction is not None
        if since is not None and not state.stuck:
            spans.append((since, t))
        since = state.since
    learner.events()
    if since is not None:
        spans.append((since, float(run.poses.t[-1])))
    return spans, judged, poses


def watched(data: DataSet, log: Log, input_name: str) -> Watched:
    """Push one log, and look at each alarm."""
    learner = _core.MotionLearner(core_settings(Settings(), input_name, (1.0, 2.0, 5.0)))
    alarms, judged, poses, seconds = [], 0, 0, 0.0
    for i, run in enumerate(log.runs):
        spans, of_run, of_poses = alarms_of(learner, run)
        judged, poses = judged + of_run, poses + of_poses
        seconds += float(run.poses.t[-1] - run.poses.t[0]) if len(run.poses) else 0.0
        commands, wheels, _, measured = recording_rows(run)
        inputs = commands if input_name == "command" else wheels
        for since, until in spans:
            begin = since - WINDOW
            asked, done = asked_of(inputs, begin, until), done_of(measured, begin, until)
            first = float(run.poses.t[0])
            alarms.append(Alarm(data.name, input_name, i, since - first, until - first, asked, done))
    return Watched(data.name, input_name, seconds / 60.0, judged / max(poses, 1), tuple(alarms))


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    parser.add_argument("--json", type=Path, help="write all alarms to this file too")
    arguments = parser.parse_args()
    folder = required_folder()
    chosen = [data for data in data_sets(folder) if arguments.only in data.name]
    found: list[Watched] = []
    with progress_bar("pushing") as progress:
        for k, data in enumerate(chosen):
            log = slipwise.open_log(data.path)
            found += [watched(data, log, name) for name in input_names(log)]
            progress(data.name[:24], (k + 1) / len(chosen))
    alarms = [alarm for log in found for alarm in log.alarms]
    output = Output(arguments.json)
    rows = [
        (w.log, w.input, f"{w.minutes:.1f}", f"{100.0 * w.judged:.0f}", str(len(w.alarms))) for w in found
    ]
    output.table("Logs", LOG_COLUMNS, rows)
    output.table("Alarms", ALARM_COLUMNS, [alarm.row() for alarm in alarms])
    minutes = sum(w.minutes for w in found)
    moving = sum(not alarm.still for alarm in alarms)
    output.line(f"{len(alarms)} alarms in {minutes:.0f} minutes, {moving} of them while the robot moved")
    output.document({"logs": [asdict(w) for w in found]})
    return 0


if __name__ == "__main__":
    sys.exit(main())

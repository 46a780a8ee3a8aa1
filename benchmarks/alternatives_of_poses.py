# SPDX-License-Identifier: Apache-2.0
"""What learning makes of poses and of what it knows before, each with its alternative."""

from __future__ import annotations

import itertools
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import sample_sources as sources
from alternatives import (
    CONTINUOUS,
    SEED,
    Beside,
    Errors,
    Floats,
    halves,
    held_out,
    level,
    opened,
    ratio,
    with_poses,
)
from disturbed_robot import Robot, disturbed_run
from fleet_left_out import errors_on

from slipwise import _core
from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.calibration.from_prior import KnownFleet, calibrate_from
from slipwise.calibration.learned_log import new_learner
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import SlipwiseError
from slipwise.fleet import write_prior
from slipwise.logs import Log, Poses, Run
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import empty_poses
from slipwise.logs.open_log import cut_to_span
from slipwise.logs.pose_clock import find_clock_offset, pose_motion
from slipwise.segments import recording_of

LATE = (*CONTINUOUS, "warthog_windows/asphalt_8_7_11h30s30")  # poses are 0.05 s to 0.3 s late
ROBOTS = ("husky/tile_deflated_tyres", "drive_test/husky", "drive_test/warthog", LATE[-1])
SECOND = sources.Source(std=(0.05, 0.02), late=0.15)  # a second source of poses: m, rad; s
WITHOUT_POSES, EVERY = 2.0, 8.0  # s that poses are held back, each time


def pose_rows() -> Iterator[Beside]:
    """Yield all rows of this file."""
    yield from clock_rows()
    yield from source_rows()
    yield from start_rows()
    yield from fleet_rows()


def clock_rows() -> Iterator[Beside]:
    """A learned lateness of poses beside one that the common motion of the whole log tells."""
    fixed = make_settings({"learn_clock_offset": False})
    ratios = []
    for name in LATE:
        data, log = opened(name)
        learned = held_out(log, Settings(), "wheel", data.horizon)
        try:
            shifted = opened(name, pose_clock_offset="auto")[1]
        except SlipwiseError as problem:
            print(f"{name}: {problem}", file=sys.stderr)
            shifted = log
        ratios.append(ratio(learned, held_out(shifted, fixed, "wheel", data.horizon)))
    yield Beside("pose delay", "--pose-clock-offset auto", "real", tuple(ratios))
    late = disturbed_run(Robot(clock_offset=0.15), 5.0, seed=SEED).log
    with_it = held_out(late, Settings(), "wheel")
    shifted = with_poses(late, lambda p: replace(p, t=p.t + offset_of(late)))
    yield Beside(
        "pose delay",
        "--pose-clock-offset auto",
        "simulated, 0.15 s late",
        (ratio(with_it, held_out(shifted, fixed, "wheel")),),
    )


def offset_of(log: Log) -> float:
    """Return what to add to stamps of poses by the motion that they and the wheels share [s]."""
    (run,) = log.runs
    assert run.wheels is not None
    p = run.poses
    motion = pose_motion(p.t, p.x, p.y, p.yaw)
    return find_clock_offset((run.wheels,), motion, UNKNOWN_AFTER, lagging=False).offset


def source_rows() -> Iterator[Beside]:
    """Two sources of poses beside the better of the two, found afterwards; judged on the log's own poses."""
    alternative, ratios = "the better source alone", []
    for name in CONTINUOUS:
        _, log = opened(name)
        first, rest = halves(log)
        ratios.append(_of_sources(first, lambda run: every_other(run, SEED), rest))
    yield Beside("two sources", alternative, "real, alternate poses, one 5 cm and 0.15 s late", tuple(ratios))
    run, random = sources.true_run(SEED)
    good, poor = (
        sources.seen_by(run.poses, sources.Source(), random),
        sources.seen_by(run.poses, SECOND, random),
    )
    exact = sources.true_run(SEED + 1)[0]
    judged = Log((exact,))
    lost = sources.until_lost(good)
    of_run = _of_sources(Log((run,)), lambda _: (lost, poor), judged, settings=sources.SETTINGS)
    yield Beside("two sources", alternative, "simulated, the good one lost after 20 s", (of_run,))


def every_other(run: Run, seed: int) -> tuple[Poses, Poses]:
    """Return every other pose as it is, and the rest as a poorer source would see it."""
    random = np.random.default_rng(seed)
    p = level(run.poses)
    return p.select(slice(0, None, 2)), sources.seen_by(p.select(slice(1, None, 2)), SECOND, random)


def _of_sources(
    log: Log,
    seen: Callable[[Run], tuple[Poses, Poses]],
    rest: Log,
    *,
    settings: Settings | None = None,
) -> Errors:
    found = []
    for which in ("both", "first", "second"):
        runs = []
        for run in log.runs:
            first, second = seen(run)
            alone = second if which == "second" else first
            both = {"others": {"poor": second}, "source": "first"} if which == "both" else {}
            runs.append(replace(run, poses=alone, **both))
        model = calibrate(replace(log, runs=tuple(runs)), input="wheel", settings=settings).model
        found.append(errors_on(rest, "wheel", model))
    both_errors, *single = found
    return ratio(both_errors, min(single))


def start_rows() -> Iterator[Beside]:
    """The filtered pose at which a prediction starts beside the last measured one."""
    names = (*CONTINUOUS[:2], "husky/wetgrass_bad_poses", "f1tenth/DS4", "create/MRCLAM6_R1")
    ratios = [start_ratio(opened(name)[1]) for name in names]
    yield Beside("start pose", "the last measured pose", "real", tuple(ratios))
    robot = Robot(pose_std=(0.05, 0.03))
    log = disturbed_run(robot, 5.0, seed=SEED).log
    yield Beside(
        "start pose", "the last measured pose", "simulated, poses to 5 cm and 0.03 rad", (start_ratio(log),)
    )


def start_ratio(log: Log) -> Errors:
    """Hold poses back for a while, again and again; return errors at the end over the alternative's."""
    name = "wheel" if log.runs[0].wheels is not None else "command"
    settings = for_the_ground_of(log, Settings())
    learner = new_learner(log.runs, name, settings, (5.0,))
    found = []
    for prepared in prepare_run(log, name):
        learner.start_run()
        found += _starts(learner, prepared.run)
    errors = np.array(found)
    with_it, without = np.mean(errors[:, 0], axis=0), np.mean(errors[:, 1], axis=0)
    return ratio((with_it[0], with_it[1]), (without[0], without[1]))


def _starts(learner: _core.MotionLearner, run: Run) -> Iterator[tuple[Errors, Errors]]:
    """Yield the errors from the filtered and from the measured pose at the end of each gap."""
    p, done = run.poses, -np.inf
    for start in np.arange(p.t[0] + EVERY, p.t[-1] - WITHOUT_POSES, EVERY):
        k = int(np.searchsorted(p.t, start, side="right")) - 1
        after = float(np.nextafter(p.t[k], np.inf))
        learner.push(recording_of(run, done, after))
        begun = learner.odometry()
        end = float(p.t[k]) + WITHOUT_POSES
        none = replace(run, poses=empty_poses(), others={})
        learner.push(recording_of(none, after, end))
        ended, done = learner.odometry(), end
        truth = _measured_at(p, ended.t) if ended is not None else None
        if begun is None or ended is None or truth is None or begun.frame != ended.frame:
            continue
        motion = _core.compose(_core.inverse(begun.pose), ended.pose)
        simple = _core.compose(_core.Pose2(p.x[k], p.y[k], p.yaw[k]), motion)
        yield _off(ended.pose, truth), _off(simple, truth)


def _measured_at(p: Poses, t: float) -> Floats | None:
    """Return x, y, yaw between two measured poses of one frame, no more than half a second apart."""
    k = int(np.searchsorted(p.t, t))
    if not 0 < k < len(p) or p.t[k] - p.t[k - 1] > 0.5 or p.frame[k] != p.frame[k - 1]:
        return None
    share = (t - p.t[k - 1]) / (p.t[k] - p.t[k - 1])
    turn = _core.wrap_angle(p.yaw[k] - p.yaw[k - 1])
    x, y = (c[k - 1] + share * (c[k] - c[k - 1]) for c in (p.x, p.y))
    return np.array([x, y, p.yaw[k - 1] + share * turn])


def _off(pose: _core.Pose2, truth: Floats) -> Errors:
    heading = abs(_core.wrap_angle(pose.theta - truth[2]))
    return float(np.hypot(pose.x - truth[0], pose.y - truth[1])), heading


def fleet_rows() -> Iterator[Beside]:
    """A fleet's prior and 30 s beside the ordinary prior with 30 s and with 90 s, on what follows."""
    real = {name: opened(name)[1] for name in ROBOTS}
    same = {f"robot {seed}": disturbed_run(Robot(), 5.0, seed=seed).log for seed in range(6)}
    fleets = (("real, 2 Huskies and 2 Warthogs", real), ("simulated, 6 of a kind", same))
    for (where, logs), name in itertools.product(fleets, ("command", "wheel")):
        found = _of_fleet(logs, name)
        for seconds, ratios in zip((30, 90), zip(*found, strict=True), strict=True):
            yield Beside(
                "fleet prior, 30 s", f"ordinary prior, {seconds} s", f"{where}, {name}s", tuple(ratios)
            )


def _of_fleet(logs: Mapping[str, Log], input_name: str) -> list[tuple[Errors, Errors]]:
    """Return the errors of each robot with the others' prior over those with 30 s and with 90 s alone."""
    known = {name: calibrate_from(log, None, input=input_name)[1] for name, log in logs.items()}
    found = []
    for name, log in logs.items():
        others = [(other, each) for other, each in known.items() if other != name and each is not None]
        first, longer = cut_to_span(log, None, 30.0), cut_to_span(log, None, 90.0)
        with tempfile.TemporaryDirectory() as folder:
            prior = KnownFleet.load(write_prior(Path(folder) / "prior.yaml", (), others))
            begun = calibrate_from(first, prior, input=input_name)[0]
        fresh = [calibrate_from(part, None, input=input_name)[0] for part in (first, longer)]
        rest = cut_to_span(log, 90.0, None)
        with_it, *without = (errors_on(rest, input_name, each.model) for each in (begun, *fresh))
        found.append((ratio(with_it, without[0]), ratio(with_it, without[1])))
    return found

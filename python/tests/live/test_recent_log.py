# SPDX-License-Identifier: Apache-2.0
"""A live node finds in its last two minutes what a log shows as a whole, and says it once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, circular, sound_log
from faulty_logs import FAULTS, with_fault

from slipwise.live.recent_log import KEPT, RecentLog
from slipwise.live.samples import Command, Pose, Reading, Stamped, Wheels
from slipwise.logs import Log

LOG = sound_log(replace(SKID_STEERED, seconds=150.0))


def samples_of(log: Log) -> list[Stamped]:
    (run,) = log.runs
    samples: list[Stamped] = [Pose(*row) for row in zip(*_columns(run.poses, "x", "y", "yaw"), strict=True)]
    for kind, inputs in ((Command, run.commands), (Wheels, run.wheels)):
        rows = zip(*_columns(inputs, "v", "omega", "vy"), strict=True)
        samples += [kind(t, v, omega, vy) for t, v, omega, vy in rows]
    return sorted(samples, key=lambda each: each.t)


def test_heights_clear_a_sensor_that_seems_to_lean_where_a_spiral_climbs() -> None:
    leaning, climbing = RecentLog("wheel", 0.5), RecentLog("wheel", 0.5)
    said, cleared = set[str](), set[str]()
    for t in np.arange(0.0, 150.0, 0.1).tolist():  # 1 m/s, a round of 20 m, 0.12 rad up
        yaw = 0.314 * t
        pose = Pose(t, 3.18 * np.sin(yaw), -3.18 * np.cos(yaw), yaw, roll=0.01, pitch=-0.12)
        for recent in (leaning, climbing):
            recent.take(Wheels(t, 1.0, 0.314))
        leaning.take(pose)
        climbing.take(replace(pose, z=0.12 * t))
        said |= {each.kind for each in leaning.found()}
        cleared |= {each.kind for each in climbing.found()}
    assert "askew-attitude" in said
    assert "askew-attitude" not in cleared


def test_a_source_of_another_scale_is_found_beside_the_first() -> None:
    for scale, kinds in ((1.0, set()), (1.06, {"source-scale"})):
        recent, found = RecentLog("wheel", 0.5), set[str]()
        for sample in samples_of(LOG):
            recent.take(replace(sample, source="gps") if isinstance(sample, Pose) else sample)
            if isinstance(sample, Pose):
                further = replace(sample, x=scale * sample.x, y=scale * sample.y, yaw=np.nan, source="map")
                recent.take(further, further=True)
            found |= {each.kind for each in recent.found()}
        assert found == kinds


def test_a_further_source_that_repeats_the_wheels_is_found() -> None:
    (run,), (repeats,) = LOG.runs, circular(LOG).runs
    for poses, kinds in ((run.poses, set()), (repeats.poses, {"repeated-wheels"})):
        recent, found = RecentLog("wheel", 0.5), set[str]()
        others = [Pose(*row, source="odom") for row in zip(*_columns(poses, "x", "y", "yaw"), strict=True)]
        for sample in sorted([*samples_of(LOG), *others], key=lambda each: each.t):
            recent.take(sample, further=isinstance(sample, Pose) and sample.source == "odom")
            found |= {each.kind for each in recent.found()}
        assert found == kinds


def test_a_gyro_of_another_scale_is_found_beside_positions_alone() -> None:
    (run,) = LOG.runs
    yaw = np.unwrap(run.poses.yaw)
    rates = zip(run.poses.t[1:].tolist(), (np.diff(yaw) / np.diff(run.poses.t)).tolist(), strict=True)
    turns = [Reading(t - 0.025, "gyro_z", rate) for t, rate in rates]
    positions = [replace(each, yaw=np.nan) if isinstance(each, Pose) else each for each in samples_of(LOG)]
    for scale, kinds in ((1.0, set()), (1.15, {"gyro-scale"})):
        recent, found = RecentLog("wheel", 0.5), set[str]()
        gyro = [replace(each, value=scale * each.value) for each in turns]
        for sample in sorted((*positions, *gyro), key=lambda each: each.t):
            recent.take(sample)
            found |= {each.kind for each in recent.found()}
        assert found == kinds


def _columns(series: object, *names: str) -> list[list[float]]:
    return [np.asarray(getattr(series, name)).tolist() for name in ("t", *names)]


def kinds_of(log: Log) -> set[str]:
    recent, found = RecentLog("wheel", 0.5), set[str]()
    for sample in samples_of(log):
        recent.take(sample)
        found |= {each.kind for each in recent.found()}
    return found


@pytest.mark.parametrize(
    ("fault", "kind"),
    [
        ("spikes of 20 times", "wheel-spikes"),
        ("odometry echoes the command", "echoed-commands"),
        ("frozen localiser", "frozen-poses"),
        ("poses 2 s late", "clock-offset"),
        ("poses' clock drifts", "clock-drift"),
        ("poses' clock steps", "clock-drift"),
    ],
)
def test_a_fault_is_found_while_the_robot_drives(fault: str, kind: str) -> None:
    assert kinds_of(with_fault(LOG, FAULTS[fault].change)) == {kind}


def test_nothing_is_found_of_a_sound_robot_and_little_is_kept() -> None:
    recent = RecentLog("wheel", 0.5)
    for sample in samples_of(LOG):
        recent.take(sample)
        assert recent.found() == ()
    (run,) = recent._log().runs
    assert run.span[1] - run.span[0] == pytest.approx(KEPT, abs=0.1)
    recent.restart()
    assert recent.found() == ()


def test_where_a_further_source_sits_is_learned_as_it_comes_and_at_the_end() -> None:
    recent, early = RecentLog("wheel", 0.5), set[int]()
    for sample in samples_of(LOG):
        recent.take(replace(sample, source="gps") if isinstance(sample, Pose) else sample)
        if isinstance(sample, Pose) and sample.t > 2.0:
            x, y = sample.x + 0.3 * np.cos(sample.yaw), sample.y + 0.3 * np.sin(sample.yaw)
            recent.take(replace(sample, t=sample.t + 0.05, x=x, y=y, source="map"), further=True)
            early.add(len(recent.mounts()))
    assert early == {0, 1}
    (mount,) = recent.mounts(last=True)
    assert (mount.name, mount.beside) == ("map", "gps")
    assert np.all(np.abs(mount.value - (0.3, 0.0, 0.0, 0.05)) < 3.0 * mount.std + 1e-3)
    recent.restart()
    assert recent.mounts() == (mount,)

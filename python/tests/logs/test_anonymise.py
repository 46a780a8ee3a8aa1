# SPDX-License-Identifier: Apache-2.0
"""An anonymised log says nothing of place, time and names, and has the motions that it had."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_run

from slipwise.errors import LogError
from slipwise.logs import Inputs, Log, Run, anonymised
from slipwise.logs.log import Forces

EPOCH, EAST, NORTH, HEADING = 1.7e9, 4.5e5, 5.3e6, 2.1


def far_away(run: Run, *, start: float = EPOCH, name: str = "field of Smith") -> Run:
    """The run at a place and a time of day, with columns that tell both."""
    poses = run.poses
    cos, sin = np.cos(HEADING), np.sin(HEADING)
    moved = replace(
        poses,
        t=poses.t + start,
        x=EAST + cos * poses.x - sin * poses.y,
        y=NORTH + sin * poses.x + cos * poses.y,
        yaw=np.arctan2(np.sin(poses.yaw + HEADING), np.cos(poses.yaw + HEADING)),
        frame=poses.frame + 7,
        z=np.linspace(412.0, 413.0, len(poses)),
    )
    extra = {
        "t": poses.t + start,
        "latitude": np.full(len(poses), 47.4),
        "wheel_left": np.arange(len(poses), dtype=np.float64),
        "terrain": np.full(len(poses), "sand", dtype=object),
    }

    def later(inputs: Inputs | None) -> Inputs | None:
        return None if inputs is None else replace(inputs, t=inputs.t + start)

    return Run(name, later(run.commands), later(run.wheels), moved, extra)


def relative(run: Run) -> np.ndarray:
    """T_k_k+1 of the poses, [N - 1, 3]."""
    x, y, yaw = run.poses.x, run.poses.y, run.poses.yaw
    cos, sin = np.cos(yaw[:-1]), np.sin(yaw[:-1])
    turned = np.diff(yaw)
    steps = (cos * np.diff(x) + sin * np.diff(y), cos * np.diff(y) - sin * np.diff(x))
    return np.column_stack((*steps, np.arctan2(np.sin(turned), np.cos(turned))))


@pytest.fixture(scope="module")
def run() -> Run:
    return simulated_run(Drive(seconds=10.0))


def test_the_first_pose_is_the_origin_and_stamps_count_from_the_start(run: Run) -> None:
    (only,) = anonymised(Log((far_away(run),))).runs
    first = [float(values[0]) for values in (only.poses.x, only.poses.y, only.poses.yaw, only.poses.t)]
    np.testing.assert_allclose(first, 0.0, atol=1e-9)
    assert only.poses.z is not None
    assert only.poses.z[0] == 0.0
    assert only.poses.z[-1] == pytest.approx(1.0)
    assert set(only.poses.frame.tolist()) == {0}


def test_motions_and_intervals_stay(run: Run) -> None:
    (only,) = anonymised(Log((far_away(run),))).runs
    np.testing.assert_allclose(relative(only), relative(run), atol=1e-8)
    np.testing.assert_allclose(np.diff(only.poses.t), np.diff(run.poses.t), atol=1e-6)
    assert run.commands is not None
    assert only.commands is not None
    np.testing.assert_array_equal(only.commands.v, run.commands.v)


def test_each_frame_of_a_run_has_an_origin_of_its_own(run: Run) -> None:
    there = far_away(run)
    frame = np.where(np.arange(len(run.poses)) < 50, 3, 9).astype(np.int64)
    (only,) = anonymised(Log((replace(there, poses=replace(there.poses, frame=frame)),))).runs
    assert np.flatnonzero(only.poses.frame == 1)[0] == 50
    assert (only.poses.x[50], only.poses.y[50], only.poses.yaw[50]) == (0.0, 0.0, 0.0)
    assert np.hypot(only.poses.x, only.poses.y).max() < 100.0


def test_names_are_hashes_that_the_same_log_gives_again(run: Run) -> None:
    log = Log((far_away(run), far_away(run, start=EPOCH + 60.0, name="another")))
    names = [each.name for each in anonymised(log).runs]
    assert names == [each.name for each in anonymised(log).runs]
    assert len(set(names)) == 2
    assert not any("Smith" in name for name in names)


def test_a_guessed_name_alone_does_not_give_the_hash(run: Run) -> None:
    here, there = anonymised(Log((far_away(run),))), anonymised(Log((far_away(run, start=EPOCH + 1.0),)))
    assert here.runs[0].name != there.runs[0].name


def test_gaps_between_runs_end_at_an_hour_and_another_clock_starts_at_zero(run: Run) -> None:
    day = 86400.0
    starts = (EPOCH, EPOCH + 100.0, EPOCH + day, 5.0)
    log = Log(tuple(far_away(run, start=start) for start in starts))
    spans = [each.span for each in anonymised(log).runs]
    assert [round(start, 3) for start, _ in spans] == [0.0, 100.0, round(spans[1][1] + 3600.0, 3), 0.0]


def test_further_sources_forces_fixes_and_positions_stay_what_they_are(run: Run) -> None:
    far = far_away(run)
    fixes = np.full(len(far.poses), 4.0)
    positions = replace(far.poses, fix=fixes, course=True)
    forces = Forces(far.poses.t, np.ones(len(far.poses)), np.zeros(len(far.poses)))
    whole = replace(far, poses=positions, others={"gnss": far.poses}, source="lidar", forces=forces)
    (only,) = anonymised(Log((whole,))).runs
    assert only.poses.course
    assert only.poses.fix is fixes
    assert only.source == "lidar"
    other = only.others["gnss"]
    np.testing.assert_allclose([other.x[0], other.y[0], other.yaw[0], other.t[0]], 0.0, atol=1e-9)
    np.testing.assert_allclose(relative(replace(only, poses=other)), relative(run), atol=1e-8)
    assert only.forces is not None
    np.testing.assert_allclose(only.forces.t, only.poses.t)


def test_only_speeds_of_the_vehicle_are_carried_along(run: Run) -> None:
    log = anonymised(Log((far_away(run),)))
    assert set(log.runs[0].extra) == {"t", "wheel_left"}
    assert log.runs[0].extra["t"][0] == 0.0
    assert log.notes == ("not carried along: latitude, terrain (--keep NAME does)",)
    assert "terrain" in anonymised(Log((far_away(run),)), keep=["terrain"]).runs[0].extra


def test_a_column_to_keep_that_is_not_there_is_an_error(run: Run) -> None:
    with pytest.raises(LogError, match=r"no column gyro to keep .*latitude, terrain, wheel_left"):
        anonymised(Log((far_away(run),)), keep=["gyro"])

# SPDX-License-Identifier: Apache-2.0
"""Tests that contradictions between poses and inputs are refused, and pose jumps taken out and counted."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs import Inputs, LeftOut, Log, Poses, Run
from slipwise.logs.quality import checked


def changed(
    log: Log, poses: Callable[[Poses], Poses] = lambda p: p, inputs: Callable[[Inputs], Inputs] = lambda i: i
) -> Log:
    runs = []
    for run in log.runs:
        assert run.commands is not None
        assert run.wheels is not None
        runs.append(
            replace(run, poses=poses(run.poses), commands=inputs(run.commands), wheels=inputs(run.wheels))
        )
    return replace(log, runs=tuple(runs))


def test_a_sound_log_passes_unchanged(log: Log) -> None:
    result = checked(log)
    assert result.left_out == ()
    assert result.runs[0].poses is log.runs[0].poses


FAULTS: dict[str, tuple[Callable[[Log], Log], str]] = {
    "yaw in degrees": (
        lambda log: changed(log, lambda p: replace(p, yaw=np.degrees(p.yaw))),
        "yaw looks like degrees",
    ),
    "omega in degrees": (
        lambda log: changed(log, inputs=lambda i: replace(i, omega=np.degrees(i.omega))),
        "looks like degrees per second",
    ),
    "x and y swapped": (
        lambda log: changed(log, lambda p: replace(p, x=p.y, y=p.x)),
        "columns look swapped: x and y",
    ),
    "v and omega swapped": (
        lambda log: changed(log, inputs=lambda i: replace(i, v=i.omega, omega=i.v)),
        "columns look swapped: v and omega",
    ),
    "z down": (
        lambda log: changed(log, lambda p: replace(p, y=-p.y, yaw=-p.yaw)),
        "frame with z down",
    ),
    "yaw clockwise": (
        lambda log: changed(log, lambda p: replace(p, yaw=-p.yaw)),
        "yaw runs clockwise",
    ),
    "compass heading": (
        lambda log: changed(log, lambda p: replace(p, yaw=0.5 * np.pi - p.yaw)),
        "compass heading",
    ),
    "millimetres": (
        lambda log: changed(log, lambda p: replace(p, x=1000.0 * p.x, y=1000.0 * p.y)),
        "times further",
    ),
}


def test_contradictions_are_refused_with_advice(log: Log, subtests: pytest.Subtests) -> None:
    for fault, (spoil, expected) in FAULTS.items():
        with subtests.test(fault=fault):
            with pytest.raises(LogError, match=expected) as caught:
                checked(spoil(log))
            assert caught.value.advice


def with_offset(run: Run, start: int, stop: int, offset: float) -> Log:
    x = run.poses.x.copy()
    x[start:stop] += offset
    return Log(runs=(replace(run, poses=replace(run.poses, x=x)),))


@pytest.fixture
def slow(drive: Callable[..., Run]) -> Run:
    """A robot slow enough that a jump of 1 m stands out."""
    run = drive()
    assert run.commands is not None
    p, i = run.poses, run.commands
    return replace(
        run,
        poses=replace(p, x=0.1 * p.x, y=0.1 * p.y),
        commands=replace(i, v=0.1 * i.v),
        wheels=replace(i, v=0.1 * i.v),
    )


def test_a_lasting_jump_starts_a_new_frame(slow: Run) -> None:
    result = checked(with_offset(slow, 300, len(slow.poses), 1.0))
    frame = result.runs[0].poses.frame
    assert frame[:300].max() == 0
    assert frame[300:].min() == 1
    (entry,) = result.left_out
    assert (entry.kind, entry.count) == ("pose-jump", 1)
    assert "t = 30.000 s" in entry.where


@pytest.mark.parametrize("length", [1, 3])
def test_a_short_outlier_is_dropped_and_the_frame_kept(slow: Run, length: int) -> None:
    result = checked(with_offset(slow, 300, 300 + length, 1.5))
    poses = result.runs[0].poses
    assert len(poses) == len(slow.poses) - length
    assert poses.frame.max() == 0
    (entry,) = result.left_out
    assert (entry.kind, entry.count) == ("pose-outlier", length)


def test_poses_that_are_late_by_a_second_are_no_jumps(slow: Run) -> None:
    late = replace(slow.poses, t=slow.poses.t + 0.9)
    assert checked(Log(runs=(replace(slow, poses=late),))).left_out == ()


def test_noisy_poses_are_no_jumps(slow: Run) -> None:
    rng = np.random.default_rng(3)
    noise = rng.normal(scale=0.3, size=(2, len(slow.poses)))
    noisy = replace(slow.poses, x=slow.poses.x + noise[0], y=slow.poses.y + noise[1])
    assert checked(Log(runs=(replace(slow, poses=noisy),))).left_out == ()


def test_frames_that_were_there_stay_apart_after_a_jump(slow: Run) -> None:
    frames = (np.arange(len(slow.poses)) >= 600).astype(np.int64)
    run = replace(slow, poses=replace(slow.poses, frame=frames))
    result = checked(with_offset(run, 300, 600, 1.0))
    assert np.unique(result.runs[0].poses.frame).tolist() == [0, 1, 2]


def test_a_log_whose_poses_all_jump_is_refused(slow: Run) -> None:
    rng = np.random.default_rng(3)
    wild = np.repeat(rng.uniform(-50.0, 50.0, len(slow.poses) // 2 + 1), 2)[: len(slow.poses)]
    with pytest.raises(LogError, match=r"out of reach|further"):
        checked(Log(runs=(replace(slow, poses=replace(slow.poses, x=wild)),)))


@pytest.mark.parametrize("turns", [3, 1e3, -1e9])
def test_a_heading_that_is_whole_turns_off_for_a_moment_is_dropped(run: Run, turns: float) -> None:
    yaw = run.poses.yaw.copy()
    yaw[300] += turns * 2.0 * np.pi
    result = checked(Log(runs=(replace(run, poses=replace(run.poses, yaw=yaw)),)))
    assert len(result.runs[0].poses) == len(run.poses) - 1
    assert [(entry.kind, entry.count) for entry in result.left_out] == [("pose-outlier", 1)]


def test_a_heading_that_is_not_wrapped_is_no_jump(run: Run) -> None:
    unwrapped = replace(run.poses, yaw=np.unwrap(run.poses.yaw) + 500.0)
    assert checked(Log(runs=(replace(run, poses=unwrapped),))).left_out == ()


def test_a_log_whose_stamps_are_all_the_same_is_refused(run: Run) -> None:
    few = replace(
        run.poses,
        **{
            name: getattr(run.poses, name)[:1]
            for name in ("t", "x", "y", "yaw", "frame", "std_xy", "std_yaw")
        },
    )
    same = LeftOut("poses with a repeated stamp", 300, "line 3", "duplicate-stamp")
    with pytest.raises(LogError, match="stamps do not go forward in 300 of 301 poses"):
        checked(Log(runs=(replace(run, poses=few),), left_out=(same,)))

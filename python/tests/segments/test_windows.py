# SPDX-License-Identifier: Apache-2.0
"""Windows are disjoint, lie between good poses under known inputs, and depend on nothing after them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, held, inputs_until, poses_of, simulated_run, steady_run, with_poses

from slipwise import _core
from slipwise.logs import Inputs, Poses, Run
from slipwise.segments import WindowRules, Windows, cut_windows

RULES = WindowRules()


def cut(run: Run, length: float, rules: WindowRules = RULES) -> Windows:
    return cut_windows([run], rules.stream_settings(length, from_commands=True))


def left_out(windows: Windows) -> dict[str, int]:
    return {item.kind: item.count for item in windows.left_out}


def pairs(windows: Windows) -> list[tuple[float, float]]:
    return list(zip(np.round(windows.start, 6).tolist(), np.round(windows.end, 6).tolist(), strict=True))


def straight_poses(t: list[float] | np.ndarray, frame: list[int] | None = None) -> Poses:
    stamps = np.array(t, dtype=np.float64)
    return poses_of(stamps, np.column_stack((stamps, 0.0 * stamps, 0.0 * stamps)), frame)


def run_of(poses: Poses, inputs: Inputs) -> Run:
    return Run(name="hand-made", commands=inputs, wheels=inputs, poses=poses)


def test_windows_follow_each_other_without_a_gap() -> None:
    windows = cut(steady_run(seconds=10.0), 2.0)
    assert pairs(windows) == [(0.0, 2.0), (2.0, 4.0), (4.0, 6.0), (6.0, 8.0), (8.0, 10.0)]
    assert windows.left_out == ()


def test_windows_overlap_where_a_stride_is_given() -> None:
    windows = cut(steady_run(seconds=4.0), 2.0, replace(RULES, stride=0.5))
    assert pairs(windows) == [(0.0, 2.0), (0.5, 2.5), (1.0, 3.0), (1.5, 3.5), (2.0, 4.0)]


def test_window_longer_than_the_run_does_not_exist() -> None:
    assert len(cut(steady_run(seconds=1.9), 2.5)) == 0


def test_end_is_the_nearest_pose_within_the_tolerance() -> None:
    run = run_of(straight_poses([0.0, 0.4, 0.8, 1.2, 1.6, 2.0]), held(np.arange(0.0, 2.1, 0.1)))
    assert pairs(cut(run, 1.0)) == [(0.0, 0.8), (0.8, 1.6)]


def test_no_pose_within_the_tolerance_makes_no_window() -> None:
    run = run_of(straight_poses([0.0, 0.1, 0.2, 0.3, 0.4, 2.0]), held(np.arange(0.0, 2.1, 0.1)))
    assert len(cut(run, 1.0)) == 0


def test_measured_pose_is_that_between_the_two_poses() -> None:
    run = simulated_run(Drive(seconds=30.0, seed=3))
    windows = cut(run, 1.5)
    assert len(windows) == 20
    for start, end, measured in zip(windows.start, windows.end, windows.measured, strict=True):
        i, j = (int(np.searchsorted(run.poses.t, t)) for t in (start, end))
        world = [_core.Pose2(run.poses.x[k], run.poses.y[k], run.poses.yaw[k]) for k in (i, j)]
        expected = _core.between(*world).vector()
        assert measured[:2] == pytest.approx(expected[:2], abs=1e-12)
        assert _core.wrap_angle(measured[2] - expected[2]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("omega", [2.0, -2.0])
def test_heading_is_unwrapped_over_several_turns(omega: float) -> None:
    windows = cut(steady_run(seconds=20.0, v=0.0, omega=omega), 10.0)
    assert windows.measured[:, 2] == pytest.approx([10.0 * omega, 10.0 * omega], abs=1e-9)


def test_late_pose_after_a_gap_is_never_an_end_or_a_start() -> None:
    t = np.concatenate((np.arange(0.0, 4.05, 0.1), np.arange(5.0, 9.05, 0.1)))
    windows = cut(run_of(straight_poses(t), held(np.arange(0.0, 9.1, 0.1))), 1.0)
    assert left_out(windows) == {"late-pose": 1}
    assert 5.0 not in np.round(windows.start, 6).tolist() + np.round(windows.end, 6).tolist()
    assert pairs(windows)[4] == (5.1, 6.1)
    assert "t = 5.000 s" in windows.left_out[0].where


def test_poses_are_late_against_the_rate_until_then() -> None:
    fast, slow = np.arange(0.0, 10.0, 0.1), np.arange(10.0, 60.0, 0.4)
    windows = cut(run_of(straight_poses(np.concatenate((fast, slow))), held(np.arange(0.0, 60.0, 0.1))), 2.0)
    assert windows.start.max() > 55.0
    assert left_out(windows)["late-pose"] < 100


def test_unknown_input_is_not_crossed() -> None:
    t = np.concatenate((np.arange(0.0, 4.05, 0.1), np.arange(6.0, 10.05, 0.1)))
    run = run_of(straight_poses(np.arange(0.0, 10.05, 0.1)), held(t))
    windows = cut(run, 1.0)
    known = [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0), (6.0, 7.0), (7.0, 8.0), (8.0, 9.0), (9.0, 10.0)]
    assert pairs(windows) == known
    assert set(left_out(windows)) == {"unknown-input"}


def test_input_is_known_for_exactly_as_long_as_the_rules_say() -> None:
    t = np.concatenate((np.arange(0.0, 2.05, 0.1), np.arange(3.0, 5.05, 0.1)))
    poses = straight_poses(np.arange(0.0, 5.05, 0.1))
    assert (1.5, 2.5) in pairs(cut(run_of(poses.select(poses.t > 0.45), held(t)), 1.0))
    longer = WindowRules(unknown_after=1.0)
    assert pairs(cut(run_of(poses, held(t)), 1.0, longer)) == [(float(k), k + 1.0) for k in range(5)]


def test_poses_before_the_first_and_long_after_the_last_input_make_no_window() -> None:
    run = run_of(straight_poses(np.arange(0.0, 20.05, 0.1)), held(np.arange(8.0, 12.05, 0.1)))
    assert pairs(cut(run, 1.0)) == [(8.0, 9.0), (9.0, 10.0), (10.0, 11.0), (11.0, 12.0)]


def test_standing_still_is_left_out_and_counted() -> None:
    run = steady_run(seconds=10.0)
    assert run.commands is not None
    v = np.where(run.commands.t < 4.0, 0.0, 1.0)
    windows = cut(replace(run, commands=replace(run.commands, v=v)), 1.0)
    assert pairs(windows)[0] == (4.0, 5.0)
    assert left_out(windows) == {"standing-still": 4}


def test_turning_in_place_and_moving_sideways_are_no_standing_still() -> None:
    assert len(cut(steady_run(seconds=4.0, v=0.0, omega=0.3), 2.0)) == 2
    run = steady_run(seconds=4.0, v=0.0)
    assert run.commands is not None
    sideways = replace(run.commands, vy=np.full(len(run.commands), 0.3))
    assert len(cut(replace(run, commands=sideways), 2.0)) == 2


def test_heading_that_may_have_turned_by_more_than_half_a_turn_is_left_out() -> None:
    run = steady_run(seconds=10.0, v=0.0, omega=2.0, pose_rate=0.5)
    windows = cut(run, 2.0)
    assert len(windows) == 0
    assert set(left_out(windows)) == {"heading-ambiguous"}


def test_frames_are_never_crossed_though_inputs_run_on() -> None:
    t = np.arange(0.0, 8.95, 0.1)
    frame = (t // 3.0).astype(int).tolist()
    windows = cut(run_of(straight_poses(t, frame), held(np.arange(0.0, 9.0, 0.1))), 2.0)
    assert pairs(windows) == [(0.0, 2.0), (3.0, 5.0), (6.0, 8.0)]


def test_frames_shorter_than_a_window_are_windows_where_asked_for() -> None:
    t = np.array([k * 3.0 + s for k in range(3) for s in np.arange(0.0, 1.95, 0.1)])
    frame = np.repeat([0, 1, 2], 20).tolist()
    run = run_of(straight_poses(t, frame), held(np.arange(0.0, 9.0, 0.1)))
    assert len(cut(run, 2.5)) == 0
    whole = cut(run, 2.5, replace(RULES, whole_frames=True))
    assert pairs(whole) == [(0.0, 1.9), (3.0, 4.9), (6.0, 7.9)]
    assert len(cut(run, 10.0, replace(RULES, whole_frames=True))) == 0


@pytest.mark.parametrize("poses", [0, 1, 2])
def test_hardly_any_poses_are_no_crash(poses: int) -> None:
    run = run_of(straight_poses(np.arange(poses) * 1.0), held(np.arange(0.0, 3.0, 0.1)))
    assert len(cut(run, 1.0)) == max(0, poses - 1)


def test_poses_each_in_a_frame_of_its_own_make_no_window() -> None:
    run = run_of(straight_poses([0.0, 1.0, 2.0], [0, 1, 2]), held(np.arange(0.0, 3.0, 0.1)))
    assert len(cut(run, 1.0)) == 0


def test_no_window_changes_when_the_log_is_cut_off_after_its_end() -> None:
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.gamma(4.0, 0.05, size=600))
    t[300:] += 7.0
    run = run_of(straight_poses(t), held(np.arange(0.0, t[-1], 0.05)))
    whole = pairs(cut(run, 1.0))
    assert run.commands is not None
    for until in np.linspace(t[5], t[-1], 23).tolist():
        part = replace(
            run,
            commands=inputs_until(run.commands, until),
            poses=run.poses.select(run.poses.t <= until),
        )
        here = pairs(cut(part, 1.0))
        # The last pose before the cut may stand in for a nearer one behind it.
        assert here[:-1] == whole[: max(0, len(here) - 1)]


def gravity(windows: Windows) -> list[tuple[float, float]]:
    return [(segment.gx, segment.gy) for segment in windows.segments]


def test_gravity_follows_rep_103() -> None:
    """Nose down (pitch > 0) pulls forward, right side down (roll > 0) pulls to the right."""
    run = steady_run(seconds=2.0)
    size = len(run.poses)
    for roll, pitch, expected in (
        (0.0, 0.1, (9.80665 * np.sin(0.1), 0.0)),
        (0.1, 0.0, (0.0, -9.80665 * np.sin(0.1))),
        (0.0, 0.0, (0.0, 0.0)),
    ):
        tilted = replace(run.poses, roll=np.full(size, roll), pitch=np.full(size, pitch))
        assert gravity(cut(with_poses(run, tilted), 1.0))[0] == pytest.approx(expected, abs=1e-12)
    assert gravity(cut(run, 1.0)) == [(0.0, 0.0), (0.0, 0.0)]


def test_tilt_that_was_not_measured_counts_as_level() -> None:
    run = steady_run(seconds=2.0)
    unknown = np.full(len(run.poses), np.nan)
    windows = cut(with_poses(run, replace(run.poses, roll=unknown, pitch=unknown)), 1.0)
    assert gravity(windows) == [(0.0, 0.0), (0.0, 0.0)]


def test_initial_twist_is_the_last_one_measured_and_only_where_fresh() -> None:
    run = steady_run(seconds=6.0)
    wheels = Inputs(
        t=np.array([0.5, 1.9, 2.01, 3.4]),
        v=np.array([1.0, 2.0, 3.0, 4.0]),
        vy=np.array([0.1, 0.2, 0.3, 0.4]),
        omega=np.array([0.5, 0.6, 0.7, 0.8]),
    )
    model = _core.MotionModel(_core.Basis("none", [], [], []), True, False)
    fresh = cut(replace(run, wheels=wheels), 2.0).segments
    bare = cut(replace(run, wheels=None), 2.0).segments
    still = _core.InputHistory(np.array([-9.0]), np.zeros(1), np.zeros(1), np.zeros(1))
    lags = np.log([1.0, 1.0, 0.1, 0.1])

    def gone(segment: _core.Segment) -> float:
        path = _core.integrate_segment(model, lags, still, segment, _core.Integrator.Exact)
        return float(np.hypot(*path.poses[-1][:2]))

    assert [gone(s) for s in bare] == [0.0, 0.0, 0.0]
    assert gone(fresh[0]) == 0.0  # nothing measured before the start
    assert gone(fresh[1]) > 1.0  # 1.9 s is 0.1 s before the start at 2.0 s
    assert gone(fresh[2]) == 0.0  # 3.4 s is 0.6 s before the start at 4.0 s

# SPDX-License-Identifier: Apache-2.0
"""Path segments: length, least distance, settling, overlap, the origin, and what is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs import Inputs, Poses, Run
from slipwise_thesis import _thesis
from slipwise_thesis.steady import HoldRules, PathRules, SteadyPaths, cut_paths

RULES = PathRules(settle=0.0, least_distance=0.0)


def steady_run(v: float, omega: float, seconds: float) -> Run:
    """A circle from a start that is far from the origin; the yaw as measured, wrapped."""
    t = np.arange(round(seconds / 0.1) + 1) * 0.1
    path = _thesis.steady_path(_core.BodyTwist(v, 0.0, omega), t)
    start = _core.Pose2(3.0, -2.0, 2.5)
    world = np.array([_core.compose(start, _core.Pose2(*pose)).vector() for pose in path.tolist()])
    yaw = np.arctan2(np.sin(world[:, 2]), np.cos(world[:, 2]))
    poses = Poses(t=t, x=world[:, 0].copy(), y=world[:, 1].copy(), yaw=yaw, frame=np.zeros(len(t), np.int64))
    inputs = Inputs(t=t, v=np.full(len(t), v), vy=np.zeros(len(t)), omega=np.full(len(t), omega))
    return Run(name="circle", commands=inputs, wheels=None, poses=poses)


def cut(run: Run, rules: PathRules = RULES) -> SteadyPaths:
    assert run.commands is not None
    return cut_paths(run, run.commands, rules)


def kinds(paths: SteadyPaths) -> dict[str, int]:
    return {item.kind: item.count for item in paths.left_out}


def test_segments_are_disjoint_and_start_at_the_origin() -> None:
    paths = cut(steady_run(1.0, 0.5, 9.0)).paths
    assert [round(path.start, 6) for path in paths] == [0.0, 3.0, 6.0]
    for path in paths:
        np.testing.assert_array_equal(path.poses[0], np.zeros(3))
        np.testing.assert_allclose(
            path.poses, _thesis.steady_path(_core.BodyTwist(1.0, 0.0, 0.5), path.times), atol=1e-12
        )
        assert path.overlap == 1.0


def test_overlapping_segments_say_how_often_each_datum_is_used() -> None:
    paths = cut(steady_run(1.0, 0.5, 9.0), replace(RULES, stride=1.0)).paths
    assert [round(path.start, 6) for path in paths] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert paths[0].overlap == pytest.approx(3.0)


def test_slow_segments_grow_to_the_least_distance_where_the_hold_allows_it() -> None:
    rules = replace(RULES, least_distance=2.0)
    (path,) = cut(steady_run(0.25, 0.1, 10.0), rules).paths
    assert path.distance == pytest.approx(2.0)
    short = cut(steady_run(0.25, 0.1, 5.0), rules)
    assert short.paths[0].distance == pytest.approx(1.25)
    assert kinds(short) == {"short-distance": 1}


def test_a_turn_in_place_needs_no_distance() -> None:
    paths = cut(steady_run(0.0, 1.5, 6.0), PathRules(settle=0.0))
    assert len(paths.paths) == 2
    assert paths.paths[0].poses[-1, 2] == pytest.approx(4.5)  # more than half a turn
    assert kinds(paths) == {}


def test_the_time_to_settle_is_left_out() -> None:
    (path,) = cut(steady_run(1.0, 0.0, 6.0), replace(RULES, settle=1.0, length=4.0)).paths
    assert path.start == pytest.approx(1.0)


def test_a_hold_that_is_too_short_is_counted() -> None:
    paths = cut(steady_run(1.0, 0.0, 2.0))
    assert paths.paths == ()
    assert kinds(paths) == {"short-hold": 1}


def test_gaps_between_poses_and_ambiguous_headings_make_no_segment() -> None:
    run = steady_run(1.0, 0.0, 3.0)
    keep = np.delete(np.arange(31), np.arange(10, 18))
    assert kinds(cut(replace(run, poses=run.poses.select(keep)))) == {"pose-gap": 1, "short-hold": 1}
    assert "heading-ambiguous" in kinds(cut(steady_run(0.0, 40.0, 3.0)))


def test_no_segment_crosses_frames() -> None:
    run = steady_run(1.0, 0.0, 8.0)
    frame = (run.poses.t > 4.05).astype(np.int64)
    paths = cut(replace(run, poses=replace(run.poses, frame=frame))).paths
    assert [round(path.start, 6) for path in paths] == [0.0, 4.1]


@pytest.mark.parametrize(
    "rules",
    [
        PathRules(length=0.0),
        PathRules(stride=-1.0),
        PathRules(settle=np.nan),
        PathRules(hold=HoldRules(speed=-0.1)),
    ],
)
def test_rules_that_make_no_sense_are_refused(rules: PathRules) -> None:
    with pytest.raises(SettingsError):
        cut(steady_run(1.0, 0.0, 6.0), rules)

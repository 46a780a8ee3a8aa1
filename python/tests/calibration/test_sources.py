# SPDX-License-Identifier: Apache-2.0
"""Several sources of poses: what is learned is true, not worse than by the better one, better in its gaps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_positions import SLIP
from sample_sources import SETTINGS, Source, run_of, seen_by, true_run, until_lost

import slipwise as sw
from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.source_knowledge import learned_sources
from slipwise.errors import SettingsError
from slipwise.logs import Log, Poses, Run
from slipwise.logs.fixes import CODES
from slipwise.segments import recording_of, source_names

HORIZONS = (1.0, 2.0, 5.0)
POOR = Source(std=(0.1, 0.02), late=0.2, every=2)


def learned(run: Run, settings: sw.Settings = SETTINGS) -> _core.MotionLearner:
    names = source_names([run])
    learner = _core.MotionLearner(core_settings(settings, "wheel", HORIZONS, coming=sw.Coming(sources=names)))
    learner.start_run()
    learner.push(recording_of(run, sources=names))
    learner.end_run()
    return learner


def estimate(learner: _core.MotionLearner) -> tuple[np.ndarray, np.ndarray]:
    found = learner.model().motion.estimate
    return found.mean[:6] - SLIP, found.covariance[:6, :6]


@pytest.mark.slow
def test_a_late_and_inexact_source_beside_a_good_one_makes_nothing_worse_and_fills_its_gaps() -> None:
    normalised, alone, both = [], [], []
    for seed in range(6):
        run, random = true_run(seed)
        good, poor = seen_by(run.poses, Source(), random), seen_by(run.poses, POOR, random)
        with_poor, good_alone = (learned(run_of(run, good, **more)) for more in ({"other": poor}, {}))
        (error, covariance), (expected, _) = estimate(with_poor), estimate(good_alone)
        assert np.all(np.abs(error - expected) < 0.05 * np.sqrt(np.diag(covariance)))
        error, covariance = estimate(learned(run_of(run, until_lost(good))))
        alone.append((error, np.sqrt(np.diag(covariance))))
        learner = learned(run_of(run, until_lost(good), other=poor))
        error, covariance = estimate(learner)
        both.append((error, np.sqrt(np.diag(covariance))))
        normalised.append(error @ np.linalg.solve(covariance, error))
        _, other = learned_sources(learner, ("first", "other"))
        assert other.segments > 120
        assert abs(other.late - POOR.late) < 3.0 * max(other.late_std, 0.01)
    z = np.array([error / std for error, std in both])
    assert np.abs(z).max() < 4.0
    assert 0.4 < np.mean(normalised) / 6.0 < 1.7
    rms = [np.sqrt(np.mean([error**2 for error, _ in each], axis=0)) for each in (alone, both)]
    std = [np.mean([std for _, std in each], axis=0) for each in (alone, both)]
    assert np.all(std[1] < 0.6 * std[0])
    assert np.all(
        rms[1][4:] < 0.9 * rms[0][4:]
    )  # of turns; its headings are four times as exact as its positions
    assert np.exp(np.mean(np.log(rms[1] / rms[0]))) < 1.0


def test_the_place_of_a_source_is_learned_where_it_is_asked_for() -> None:
    run, random = true_run(3)
    placed = Source(std=(0.02, 0.01), late=-0.1, sensor=(0.4, 0.2, 0.1))
    good, other = seen_by(run.poses, Source(), random), seen_by(run.poses, placed, random)
    settings = sw.make_settings(
        {"basis": "full-linear-6", "pose_sources": [{"name": "other", "learn_extrinsics": True}]}
    )
    found = learned_sources(learned(run_of(run, good, other=other), settings), ("first", "other"))[1]
    assert np.abs(found.sensor - placed.sensor).max() < 0.03
    assert found.late == pytest.approx(placed.late, abs=0.03)
    assert "other" in found.sentence()
    with pytest.raises(SettingsError, match="'other', which is the first source"):
        core_settings(settings, "wheel", HORIZONS, coming=sw.Coming(sources=("other", "lidar")))


def with_fixes(poses: Poses, fix: np.ndarray) -> Poses:
    return Poses(t=poses.t, x=poses.x, y=poses.y, yaw=poses.yaw, frame=poses.frame, fix=fix)


@pytest.mark.slow
def test_errors_of_each_fix_are_learned_apart_and_poor_ones_are_rejected_and_counted() -> None:
    run, random = true_run(5)
    exact = run.poses
    fix = np.full(len(exact), float(CODES["rtk_fixed"]))
    part = (exact.t % 40.0) / 40.0
    fix[part > 0.5], fix[part > 0.8] = CODES["rtk_float"], CODES["single"]
    std = np.select([fix == CODES["single"], fix == CODES["rtk_float"]], [1.5, 0.1], 0.01)
    noise = random.standard_normal((3, len(exact)))
    poses = with_fixes(exact, fix)
    poses = replace(
        poses,
        x=exact.x + std * noise[0],
        y=exact.y + std * noise[1],
        yaw=exact.yaw + 0.5 * std * noise[2],
    )
    run = replace(run, poses=poses)
    learner = learned(run)
    (found,) = learned_sources(learner, source_names([run]))
    assert {"rtk_fixed", "rtk_float"} <= set(found.noise)
    assert np.all(found.noise["rtk_fixed"] == 1.0)
    assert 4.0 < np.exp(np.log(found.noise["rtk_float"]).mean()) < 25.0
    error, covariance = estimate(learner)
    assert np.abs(error / np.sqrt(np.diag(covariance))).max() < 4.0
    counts = np.array(learner.model().rejected)
    assert counts[2].sum() > 0  # of poses
    blind = estimate(learned(replace(run, poses=with_fixes(poses, np.full(len(poses), np.nan)))))
    assert np.trace(covariance) < np.trace(blind[1])


@pytest.mark.slow
def test_one_source_of_one_fix_is_learned_as_ever() -> None:
    run, random = true_run(2)
    poses = seen_by(run.poses, Source(), random)
    fixed = with_fixes(poses, np.full(len(poses), float(CODES["rtk_fixed"])))
    assert source_names([replace(run, poses=fixed)]) == ()
    texts = [
        sw.calibrate(Log((replace(run, poses=each),)), input="wheel").model.to_yaml()
        for each in (poses, fixed)
    ]
    assert texts[0] == texts[1]


def test_a_learner_takes_sources_by_name() -> None:
    learner = sw.MotionLearner("wheel", SETTINGS, coming=sw.Coming(sources=("lidar", "gnss")))
    learner.start_run("field")
    for k in range(300):
        t = 0.1 * k
        learner.push_wheels(t, 1.0, 0.2)
        learner.push_pose(t, 5.0 * np.sin(0.2 * t), 5.0 * (1.0 - np.cos(0.2 * t)), 0.2 * t)
        learner.push_position(
            t - 0.05,
            5.0 * np.sin(0.2 * t - 0.01),
            5.0 * (1.0 - np.cos(0.2 * t - 0.01)),
            source="gnss",
            fix="rtk_fixed",
        )
    assert [source.name for source in learner.sources] == ["lidar", "gnss"]
    again = sw.MotionLearner.load(learner.save())
    assert [source.segments for source in again.sources] == [source.segments for source in learner.sources]
    with pytest.raises(SettingsError, match="unknown source of poses 'radar'"):
        learner.push_pose(31.0, 0.0, 0.0, 0.0, source="radar")
    with pytest.raises(SettingsError, match="this learner expects poses"):
        learner.push_position(31.0, 0.0, 0.0)
    with pytest.raises(SettingsError, match="tells no fixes apart"):
        sw.MotionLearner("wheel").push_pose(0.0, 0.0, 0.0, 0.0, fix="single")
    with pytest.raises(SettingsError, match="two sources have one name"):
        sw.MotionLearner("wheel", coming=sw.Coming(sources=("a", "a")))

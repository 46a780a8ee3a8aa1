# SPDX-License-Identifier: Apache-2.0
"""A learner says where the robot is: near the truth, in the frame of the poses, and with its uncertainty."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise import MotionLearner


def driven(seconds: float, *, poses_until: float, input_name: str = "command") -> MotionLearner:
    """A robot that drives 0.5 m/s along a line at 3 rad, and is seen exactly where it is."""
    learner = MotionLearner(input=input_name)
    learner.start_run("line")
    push = learner.push_command if input_name == "command" else learner.push_wheels
    for t in np.arange(0.0, seconds, 0.05).tolist():
        push(t, 0.5, 0.0)
        if t < poses_until:
            learner.push_pose(t, 0.5 * t * np.cos(3.0), 0.5 * t * np.sin(3.0), 3.0)
        learner.odometry()
    return learner


def test_there_is_no_odometry_before_the_first_pose() -> None:
    learner = MotionLearner()
    learner.start_run("run")
    assert learner.odometry() is None
    learner.push_command(0.0, 0.5, 0.0)
    assert learner.odometry() is None


@pytest.mark.parametrize("input_name", ["command", "wheel"])
def test_the_pose_goes_on_where_poses_stop(input_name: str) -> None:
    odometry = driven(22.0, poses_until=20.0, input_name=input_name).odometry()
    assert odometry is not None
    assert odometry.since_pose == pytest.approx(2.0, abs=1e-6)
    along = 0.5 * odometry.t * np.array([np.cos(3.0), np.sin(3.0)])
    assert odometry.pose[:2] == pytest.approx(along, abs=0.05)
    assert odometry.pose[2] == pytest.approx(3.0, abs=0.02)
    assert odometry.twist == pytest.approx([0.5, 0.0, 0.0], abs=0.02)
    assert odometry.frame == 0


def test_the_covariance_is_one_and_grows_without_poses_along_the_axes_of_the_frame() -> None:
    seen, later = driven(20.0, poses_until=30.0).odometry(), driven(22.0, poses_until=20.0).odometry()
    assert seen is not None
    assert later is not None
    for odometry in (seen, later):
        for covariance in (odometry.covariance, odometry.twist_covariance):
            assert covariance == pytest.approx(covariance.T)
            assert np.linalg.eigvalsh(covariance)[0] > 0.0
    assert np.all(np.diag(later.covariance) > np.diag(seen.covariance))


@pytest.mark.slow
def test_the_pose_is_at_its_stamp_where_late_poses_pass_for_a_delay_of_the_drive() -> None:
    random, step, late = np.random.default_rng(3), 0.02, 0.2
    learner = MotionLearner(input="command")
    learner.start_run("course")
    pose, poses, errors, squares = np.zeros(3), [], [], []
    for k, t in enumerate(np.arange(0.0, 70.0, step).tolist()):
        if k % 75 == 0:
            v, omega = random.uniform(0.2, 1.0), random.uniform(-0.8, 0.8)
        learner.push_command(t, v, omega)
        learner.push_wheels(t, v, omega)
        if k >= 10 and k % 3 == 0:
            learner.push_pose(
                t, *(poses[k - round(late / step)] + random.normal((0, 0, 0), (0.02, 0.02, 0.01)))
            )
        poses.append(pose)
        odometry = learner.odometry()
        if odometry is not None and t > 30.0:
            error = odometry.pose - pose
            error[2] = (error[2] + np.pi) % (2.0 * np.pi) - np.pi
            errors.append(error)
            squares.append(error @ np.linalg.solve(odometry.covariance, error))
        heading = pose[2] + 0.3 * omega * step
        pose = pose + step * np.array([0.9 * v * np.cos(heading), 0.9 * v * np.sin(heading), 0.6 * omega])
    position, heading_error = np.hypot(*np.transpose(errors)[:2]), np.abs(np.transpose(errors)[2])
    assert np.mean(position) < 0.02  # 0.1 where the lateness is not taken from the stamps
    assert np.mean(heading_error) < 0.01
    assert 0.3 < np.mean(squares) < 4.5


def test_a_heading_is_wrapped() -> None:
    learner = MotionLearner()
    learner.start_run("run")
    learner.push_command(0.0, 0.0, 0.0)
    learner.push_pose(0.01, 0.0, 0.0, 7.0)
    odometry = learner.odometry()
    assert odometry is not None
    assert odometry.pose[2] == pytest.approx(7.0 - 2.0 * np.pi)


@pytest.mark.parametrize("input_name", ["command", "wheel"])
def test_a_robot_that_stops_although_it_is_told_to_drive_is_stuck_until_it_drives(input_name: str) -> None:
    random = np.random.default_rng(5)
    learner = MotionLearner(input=input_name)
    learner.start_run("line")
    push = learner.push_command if input_name == "command" else learner.push_wheels
    x, states = 0.0, {}
    for t in np.arange(0.0, 48.0, 0.05).tolist():
        speed = 0.4 + 0.2 * np.sin(0.7 * t)
        push(t, speed, 0.0)
        x += 0.0 if 40.0 <= t < 45.0 else 0.9 * speed * 0.05
        learner.push_pose(t, *(random.normal((x, 0.0, 0.0), 0.005).tolist()))
        states[round(t, 2)] = learner.motion_monitor()
    stuck = [t for t, state in states.items() if state.stuck]
    assert 40.0 < stuck[0] < 41.0
    assert 45.0 < stuck[-1] < 46.0
    assert states[43.0].since == pytest.approx(stuck[0], abs=0.3)
    assert states[43.0].fraction == pytest.approx(0.0, abs=0.1)
    assert states[39.5].fraction == pytest.approx(1.0, abs=0.15)
    assert states[39.5].since is None
    assert states[1.0].fraction is None


def test_a_learner_that_was_loaded_begins_again_with_the_next_pose() -> None:
    learner = MotionLearner.load(driven(10.0, poses_until=30.0).save())
    assert learner.odometry() is None
    learner.push_pose(10.0, -4.0, 1.0, 3.0)
    odometry = learner.odometry()
    assert odometry is not None
    assert odometry.pose[:2] == pytest.approx([-4.0, 1.0])

# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/promises/limits_from_poses.py`: robots with and without limits."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.promises.disturbed_robot import STEP, Disturbance, Limits, Robot, disturbed_run
from benchmarks.promises.limits_from_poses import LIMITS, Job, Outcome, calibrated, holds


def outcome(**changed: object) -> Outcome:
    """A robot whose limits were found, its lags and delays near the truth."""
    fields = {"job": Job("limits", "white", 2.0, 0), "good": True, "found": True, "lags": (0.5, 1.0)}
    return Outcome(**({"delays": (0.1, -1.0)} | fields | changed))  # type: ignore[arg-type]


def test_a_simulated_robot_keeps_to_its_limits() -> None:
    quick = {"delay": (0.0, 0.0), "lag": (1e-6, 1e-6), "pose_std": (0.0, 0.0), "wheel_std": 0.0}
    robot = Robot(limits=(Limits(0.35, 1.1, 0.8, 1.5), Limits()), disturbance=Disturbance(0.0, 0.0), **quick)  # type: ignore[arg-type]
    (run,) = disturbed_run(robot, 5.0, seed=3).log.runs
    assert run.wheels is not None
    speed = np.abs(run.wheels.v)
    change = np.diff(speed) / np.diff(run.wheels.t)
    assert speed.max() == pytest.approx(1.1, abs=1e-9)
    assert change.max() == pytest.approx(0.8, rel=1e-2)
    assert change.min() == pytest.approx(-1.5, rel=1e-2)
    blocked = np.abs(run.commands.v) < 0.35  # type: ignore[union-attr]
    long_blocked = np.convolve(blocked, np.ones(30), mode="full")[: len(blocked)] > 29.5
    assert long_blocked.any()
    assert speed[long_blocked[: len(speed)]].max() < 1.5 * STEP


@pytest.mark.parametrize("limits", LIMITS)
def test_limits_are_found_where_there_are_some(limits: str) -> None:
    found = calibrated(Job(limits, "white", 2.0, 1))
    assert found.found == (limits != "none")
    assert not found.misleads
    if found.found:
        assert max(map(abs, (*found.lags, *found.delays))) < 4.0


@pytest.mark.parametrize(
    "broken",
    [
        {"lags": (3.5, 3.5)},
        {"delays": (3.5, 0.0), "lags": (0.0,) * 60},
        {"job": Job("none", "white", 2.0, 0)},
    ],
    ids=["lags far off", "a good verdict beside a delay far off", "limits where there are none"],
)
def test_a_broken_promise_is_said(broken: dict[str, object]) -> None:
    assert holds([outcome()])
    assert not holds([outcome(**broken)])

# SPDX-License-Identifier: Apache-2.0
"""The example's trailer follows as trailers do, and `benchmarks/trailer_recovery.py` finds its lengths."""

from __future__ import annotations

import runpy
from typing import Any

import numpy as np
import pytest
import trailer_recovery


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    """Return what the example defines, without running it."""
    return runpy.run_path(str(trailer_recovery.EXAMPLE))


def hitch_rate(example: dict[str, Any], hitch: float, v: float, w: float, *, offset: float = 0.3) -> float:
    """Return the rate of the hitch angle [rad/s] behind a robot without slip."""
    return float(example["rates"]((0.0, 0.0, 0.7, hitch), (v, w), (offset, 1.2, 0.0, 0.0))[3])


def test_a_towed_trailer_straightens_and_a_pushed_one_folds(example: dict[str, Any]) -> None:
    assert hitch_rate(example, 0.2, 1.0, 0.0) < 0.0 < hitch_rate(example, 0.2, -1.0, 0.0)


def test_on_a_circle_the_axles_of_robot_and_trailer_meet_at_its_centre(example: dict[str, Any]) -> None:
    v, w, offset, length = 0.8, 0.4, 0.3, 1.2
    # Seen from the hitch, the centre of the circle is abeam of the robot's axle and of the trailer's.
    to_hitch = np.hypot(v / w, offset)
    hitch = -(np.arctan2(offset, v / w) + np.arcsin(length / to_hitch))
    assert hitch_rate(example, hitch, v, w, offset=offset) == pytest.approx(0.0, abs=1e-12)


def test_left_mirrors_right(example: dict[str, Any]) -> None:
    assert hitch_rate(example, 0.3, 0.9, 0.5) == pytest.approx(-hitch_rate(example, -0.3, 0.9, -0.5))


def test_noise_that_lasts_pushes_as_far_in_the_long_run_as_white_noise(example: dict[str, Any]) -> None:
    def wandering(correlated: float) -> float:
        drives = [example["towed_drive"](seed, 20.0, correlated) for seed in range(60)]
        turned = [seen[-1, 3] - 0.1 * 0.75 * commands[:-1, 2].sum() for commands, seen in drives]
        return float(np.std(turned))

    assert wandering(0.5) == pytest.approx(wandering(0.0), rel=0.3)


@pytest.mark.slow
@pytest.mark.parametrize("noise", trailer_recovery.NOISES)
def test_offset_length_and_slip_are_within_three_sigma(example: dict[str, Any], noise: str) -> None:
    drives = [
        trailer_recovery.recover(example, 100 + seed, trailer_recovery.NOISES[noise], 60.0)
        for seed in range(6)
    ]
    z = np.array([drive.error / drive.std for drive in drives])
    assert np.sum(np.abs(z) > 3.0) <= 1
    assert np.sqrt(np.mean(z**2)) < 1.6
    assert all(drive.hitch[0] < drive.hitch[1] for drive in drives)

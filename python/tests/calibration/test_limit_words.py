# SPDX-License-Identifier: Apache-2.0
"""Advice about limits names speeds that a driver can command."""

from __future__ import annotations

import numpy as np
from limited_drives import FREE, SIDES, TRACK, search

from slipwise import _core
from slipwise.calibration.judge import doubted_limits, limits_advice
from slipwise.logs.log import Inputs
from slipwise_sim import steps_drive

NO_LIMITS = _core.CommandLimits(FREE, FREE, FREE, TRACK, 1.0, 1.0)


def searched(commands: Inputs) -> _core.LimitSearch:
    """Search for limits of a drive that has none."""
    return search(NO_LIMITS, commands, 1, TRACK)


def with_slowest(speed: float, turn: float) -> Inputs:
    """A drive in steps, none slower than 0.1, but for one of each."""
    drive = steps_drive(4, 40.0)
    v, omega = (np.where(np.abs(u) < 0.1, 0.1, u) for u in (drive.v, drive.omega))
    v[:20], omega[20:40] = speed, turn
    return Inputs(t=drive.t, v=v, vy=drive.vy, omega=omega)


def test_what_rounding_leaves_of_zero_is_no_command() -> None:
    search = searched(with_slowest(0.2, 0.1 + 0.2 - 0.3))
    assert search.reach[1].slowest >= 0.1 - 1e-12
    words = f"the smallest commands were 0.10 m/s and {search.reach[1].slowest:.2f} rad/s"
    assert words in " ".join(limits_advice(search))


def test_commands_that_are_too_small_for_a_dead_band_are_not_named() -> None:
    text = " ".join(limits_advice(searched(with_slowest(0.05, 1e-4))))
    assert "the smallest commands were 0.050 m/s." in text
    assert "dead band" not in " ".join(limits_advice(searched(with_slowest(1e-4, 1e-4))))


def test_limits_that_are_left_out_are_named() -> None:
    (sentence,) = doubted_limits(search(SIDES, steps_drive(4, 120.0), 1), wheels_logged=False)
    assert "each side: saturation" in sentence
    assert sentence.endswith("record wheel speeds.")
    assert doubted_limits(searched(steps_drive(4, 40.0)), wheels_logged=False) == ()

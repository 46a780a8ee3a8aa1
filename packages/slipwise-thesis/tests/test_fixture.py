# SPDX-License-Identifier: Apache-2.0
"""The fixture simulates once, the same again for the same seed, and says which log is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise_thesis import Fixture, FixtureSize, MissingLogError
from slipwise_thesis.steady import find_holds

pytest.importorskip("mujoco")

TINY = FixtureSize(circle_speeds=(1.0,), circle_time=1.0, one_circle_time=4.0, long_time=5.0)


def test_held_commands_are_logged_as_held_though_the_drive_is_disturbed() -> None:
    (run,) = Fixture(size=TINY).circles().log.runs
    assert run.commands is not None
    holds = find_holds(run.commands)
    assert [round(hold.omega, 3) for hold in holds] == [0.1, -0.1, 0.25, -0.25, 0.5, -0.5]
    assert np.all(run.commands.v == 1.0)
    assert run.wheels is not None
    assert np.std(run.wheels.v[-10:]) > 0.0


def test_the_same_seed_gives_the_same_drive_and_it_is_simulated_once() -> None:
    fixture = Fixture(size=TINY, seed=3)
    first = fixture.one_circle()
    assert fixture.one_circle() is first
    again, other = Fixture(size=TINY, seed=3).one_circle(), Fixture(size=TINY, seed=4).one_circle()
    np.testing.assert_array_equal(first.log.runs[0].poses.x, again.log.runs[0].poses.x)
    assert not np.array_equal(first.truth.x, other.truth.x)


def test_a_missing_log_is_named_with_advice(tmp_path: Path) -> None:
    with pytest.raises(MissingLogError, match=r"husky/tile .*SLIPWISE_DATA or --data"):
        Fixture().real_log("husky/tile")
    with pytest.raises(MissingLogError, match=r"husky/tile .*husky/tile\.csv\.gz"):
        Fixture(data=tmp_path).real_log("husky/tile")

# SPDX-License-Identifier: Apache-2.0
"""How slip wanders is learned beside a pass, causally, from the windows just before each."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise.calibration import Settings, make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.coloured_pass import ColouredPass
from slipwise.calibration.drive import RECENT_SECONDS, RECENT_WINDOWS, WindowSet, prepare_drive
from slipwise.calibration.learner import make_learner
from slipwise.calibration.learning_run import start_learning
from slipwise.calibration.structure_choice import learning_pass
from slipwise.errors import SettingsError

SETTINGS = Settings(basis="edd-2")


@pytest.fixture(scope="module")
def windows() -> WindowSet:
    return learning_windows(prepare_drive(simulated_log(Drive(seconds=90.0)), "wheel"), "wheel", SETTINGS)


def coloured_pass(windows: WindowSet) -> ColouredPass:
    learner = make_learner(SETTINGS, "wheel")
    return ColouredPass(learning_pass(learner.fresh(), windows, SETTINGS).belief, windows, SETTINGS)


def weights(passing: ColouredPass, count: int) -> np.ndarray:
    coloured = passing.belief(count).coloured
    assert coloured is not None
    return np.array(coloured.law.weights)


def test_weights_are_those_of_the_windows_that_have_passed(windows: WindowSet) -> None:
    at_once, in_steps = coloured_pass(windows), coloured_pass(windows)
    early = weights(in_steps, 20)
    late = weights(in_steps, 60)
    np.testing.assert_array_equal(late, weights(at_once, 60))
    np.testing.assert_array_equal(early, weights(coloured_pass(windows), 20))
    assert not np.allclose(early, late)
    assert weights(coloured_pass(windows), 0)[0] == SETTINGS.coloured.white
    with pytest.raises(ValueError, match="is gone"):
        in_steps.belief(20)


def test_a_belief_keeps_what_it_knew_when_more_is_learned(windows: WindowSet) -> None:
    passing = coloured_pass(windows)
    coloured = passing.belief(10).coloured
    assert coloured is not None
    before = np.array(coloured.law.weights)
    passing.belief(50)
    np.testing.assert_array_equal(np.array(coloured.law.weights), before)


def test_recent_windows_are_few_of_the_same_run_and_young(windows: WindowSet) -> None:
    for i in (0, 3, 40):
        start = float(windows.start[i])
        recent = windows.recent(i, int(windows.position[i]), start)
        assert len(recent) == min(i, RECENT_WINDOWS)
        assert all(start - RECENT_SECONDS < segment.start < segment.end <= start + 1e-9 for segment in recent)
    assert windows.recent(40, int(windows.position[40]) + 1, float(windows.start[40])) == []
    assert windows.recent(40, int(windows.position[40]), float(windows.start[40]) + 2 * RECENT_SECONDS) == []


def with_coloured(**table: object) -> Settings:
    return make_settings({"basis": "edd-2", "coloured": table})


def test_settings_say_whether_and_what_is_tried(windows: WindowSet) -> None:
    assert start_learning(with_coloured(learn=False), "wheel", windows).belief(10).coloured is None
    one = with_coloured(fractions=[0.2], time_constants=[7.0])
    coloured = start_learning(one, "wheel", windows).belief(10).coloured
    assert coloured is not None
    assert [(c.drift, c.turn, c.time_constant) for c in coloured.law.candidates[1:]] == [
        (0.0, 0.2, 7.0),
        (0.2, 0.0, 7.0),
        (0.2, 0.2, 7.0),
    ]
    with pytest.raises(SettingsError, match=r"coloured\.fractions"):
        with_coloured(fractions=[])

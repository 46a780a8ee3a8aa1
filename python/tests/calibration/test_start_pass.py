# SPDX-License-Identifier: Apache-2.0
"""What is true of a start is learned beside a pass, causally, from the windows and poses just before each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, kept, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.drive import RECENT_SECONDS, RECENT_WINDOWS, WindowSet, prepare_drive
from slipwise.calibration.learner import make_learner
from slipwise.calibration.learning_run import start_learning
from slipwise.calibration.start_pass import StartPass
from slipwise.calibration.structure_choice import learning_pass
from slipwise.errors import SettingsError
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import Inputs, Log

SETTINGS = Settings(basis="edd-2")


@pytest.fixture(scope="module")
def windows() -> WindowSet:
    return learning_windows(prepare_drive(simulated_log(Drive(seconds=90.0)), "wheel"), "wheel", SETTINGS)


def start_pass(windows: WindowSet) -> StartPass:
    learner = make_learner(SETTINGS, "wheel")
    return StartPass(learning_pass(learner, windows).belief, windows, SETTINGS)


def weights(passing: StartPass, count: int) -> np.ndarray:
    """Of how slip wanders, and of how far back poses tell of the start."""
    belief = passing.belief(count)
    assert belief.coloured is not None
    assert belief.start is not None
    return np.concatenate((belief.coloured.law.weights, belief.start.law.weights))


def test_weights_are_those_of_the_windows_that_have_passed(windows: WindowSet) -> None:
    at_once, in_steps = start_pass(windows), start_pass(windows)
    early = weights(in_steps, 20)
    late = weights(in_steps, 60)
    np.testing.assert_array_equal(late, weights(at_once, 60))
    np.testing.assert_array_equal(early, weights(start_pass(windows), 20))
    changed = ~np.isclose(early, late)
    memories = len(SETTINGS.start.memories) + 1
    assert changed[:-memories].any()
    assert changed[-memories:].any()
    before = weights(start_pass(windows), 0)
    assert (before[0], before[-memories]) == (SETTINGS.coloured.white, SETTINGS.start.measured)
    with pytest.raises(ValueError, match="is gone"):
        in_steps.belief(20)


def test_a_belief_keeps_what_it_knew_when_more_is_learned(windows: WindowSet) -> None:
    passing = start_pass(windows)
    early = passing.belief(10)
    assert early.coloured is not None
    assert early.start is not None
    before = np.concatenate((early.coloured.law.weights, early.start.law.weights))
    passing.belief(50)
    np.testing.assert_array_equal(
        np.concatenate((early.coloured.law.weights, early.start.law.weights)), before
    )


def test_recent_windows_are_few_of_the_same_run_and_young(windows: WindowSet) -> None:
    for i in (0, 3, 40):
        start = float(windows.start[i])
        recent = windows.recent(i, int(windows.position[i]), start)
        assert len(recent) == min(i, RECENT_WINDOWS)
        assert all(start - RECENT_SECONDS < segment.start < segment.end <= start + 1e-9 for segment in recent)
    assert windows.recent(40, int(windows.position[40]) + 1, float(windows.start[40])) == []
    assert windows.recent(40, int(windows.position[40]), float(windows.start[40]) + 2 * RECENT_SECONDS) == []


def test_poses_before_a_start_are_young_of_its_frame_not_late_and_the_input_is_known(
    windows: WindowSet,
) -> None:
    run = windows.drive[0].run
    start = float(windows.start[20])
    first = int(np.searchsorted(run.poses.t, start)) - 12
    place = np.arange(len(run.poses))
    left = (place < first + 4) | (place >= first + 8)  # the next comes late, after a gap
    changed = replace(run, poses=kept(replace(run.poses, frame=(place >= first).astype(np.int64)), left))
    cut = learning_windows(prepare_drive(Log(runs=(changed,)), "wheel"), "wheel", SETTINGS)
    i = int(np.searchsorted(cut.start, start - 0.3))
    at = int(np.searchsorted(run.poses.t, cut.start[i]))
    assert at > first + 8
    usual = run.poses.t[[*range(first, first + 4), *range(first + 9, at + 1)]]
    assert cut.seen(i, 100.0).stamps == usual.tolist()
    assert cut.seen(i, 0.12).stamps == usual[usual >= cut.start[i] - 0.12].tolist()
    gap = replace(changed, wheels=without(changed.wheels, start - 1.5, start - 0.21))
    cut = learning_windows(prepare_drive(Log(runs=(gap,)), "wheel"), "wheel", SETTINGS)
    i = int(np.searchsorted(cut.start, start - 0.05))
    assert cut.seen(i, 100.0).stamps[0] >= start - 0.21


def without(inputs: Inputs | None, first: float, last: float) -> Inputs:
    assert inputs is not None
    left = (inputs.t < first) | (inputs.t > last)
    return Inputs(*(column[left] for column in (inputs.t, inputs.v, inputs.vy, inputs.omega)))


@pytest.mark.parametrize(("pose_std", "least", "most"), [((0.03, 0.005), 0.6, 0.9), ((0.0, 0.0), 0.99, 1.01)])
def test_noise_of_poses_is_averaged_out_of_starts(
    pose_std: tuple[float, float], least: float, most: float
) -> None:
    """Of the error over 1 s that two noisy poses make, one is nearly gone; without noise nothing changes."""
    drive = Drive(seconds=400.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3), pose_std=pose_std)
    options = EvaluationOptions(methods=("edd-2",), horizons=(1.0,))
    found = [
        evaluate(simulated_log(drive), input="wheel", options=options, settings=settings).predictions[0]
        for settings in (SETTINGS, make_settings({"basis": "edd-2", "start": {"learn": False}}))
    ]
    averaged, measured = (p.position_error[len(p) // 2 :].mean() for p in found)
    assert least < averaged / measured < most


def with_coloured(**table: object) -> Settings:
    return make_settings({"basis": "edd-2", "coloured": table})


def test_settings_say_whether_and_what_is_tried(windows: WindowSet) -> None:
    measured = make_settings({"basis": "edd-2", "start": {"learn": False}})
    assert start_learning(measured, "wheel", windows).belief(10).start is None
    known = make_settings({"basis": "edd-2", "start": {"memories": [0.3]}})
    start = start_learning(known, "wheel", windows).belief(10).start
    assert start is not None
    assert start.law.memories == [0.0, 0.3]
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

# SPDX-License-Identifier: Apache-2.0
"""The course of surfaces along the windows of a sequence."""

from __future__ import annotations

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.learned_sequence import learn_sequence
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings


def test_probabilities_of_each_window_add_up_and_changes_are_dated() -> None:
    drives = [prepare_run(simulated_log(Drive(seconds=60.0, seed=seed)), "wheel") for seed in range(2)]
    learned = learn_sequence(drives, Settings(), (1.0,))
    for log in learned.logs:
        assert log.course is not None
        assert np.allclose(log.course.probability.sum(axis=1), 1.0)
        assert (np.diff(log.course.t) > 0.0).all()
    recalled = next(change for change in learned.logs[1].changes if change.what == "recalled")
    course = learned.logs[1].course
    assert course is not None
    assert course.t[0] <= recalled.t <= course.t[-1]
    sure = course.probability[course.t >= recalled.t, course.names.index("surface 1")]
    assert (sure >= 0.98).all()  # as long as another that is like it competes
    assert sure[-1] == 1.0


def test_without_a_memory_there_is_no_course() -> None:
    drive = prepare_run(simulated_log(Drive(seconds=20.0)), "wheel")
    history = learn_log(drive, Settings(), (1.0,), keep=Keep(0.5)).history
    assert history is not None
    assert history.surfaces is None

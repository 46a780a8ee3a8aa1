# SPDX-License-Identifier: Apache-2.0
"""Events of the core in words: what was rejected has a reason, what was learned how far off it was."""

from __future__ import annotations

import numpy as np
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.learner_answers import event_of
from slipwise.segments import recording_of


def test_events_have_what_belongs_to_their_kind() -> None:
    learner = _core.MotionLearner(core_settings(Settings(basis="edd-2"), "wheel", (1.0, 2.0, 5.0)))
    learner.push(recording_of(simulated_run(Drive(seconds=20.0))))
    learner.push_pose(1.0, np.nan, 0.0, 0.0, 0)
    events = [event_of(event, "the run") for event in learner.events()]
    rejected = [event for event in events if event.kind == "rejected"]
    assert rejected[-1].reason == "a number is missing or impossible"
    assert rejected[-1].nis is None
    learned = [event for event in events if event.kind == "segment-learned"]
    assert len(learned) > 10
    assert all(event.nis is not None and event.nis >= 0.0 and not event.reason for event in learned)
    assert {event.run for event in events} == {"the run"}

# SPDX-License-Identifier: Apache-2.0
"""A pass serves anything that learns and believes; it never looks ahead and never goes back."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.learner import Posterior
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run

NOTHING = _core.MotionModel(_core.Basis("none", [], [], []), False, False)


@dataclass
class LastEnd:
    """Learns when its last window ended, and nothing else."""

    ends: list[float] = field(default_factory=list)

    def learn(self, _inputs: _core.InputHistory, segment: _core.Segment) -> float:
        self.ends.append(segment.end)
        return segment.end

    def posterior(self) -> Posterior:
        none = np.zeros(0)
        return Posterior(NOTHING, none, np.zeros((0, 0)), np.ones(3), none, none, np.array(self.ends[-1:]))


@pytest.fixture(scope="module")
def windows() -> WindowSet:
    settings = Settings()
    return learning_windows(prepare_run(simulated_log(Drive(seconds=60.0)), "wheel"), "wheel", settings)


def test_it_learns_in_order_as_far_as_asked_and_tells_its_observer(windows: WindowSet) -> None:
    learner, seen = LastEnd(), []
    passing = CausalPass(
        learner, windows, lambda i, end, posterior: seen.append((i, end, posterior.weights[0]))
    )
    assert len(passing.posterior(0).weights) == 0
    assert passing.posterior(5).weights[0] == windows.end[4]
    assert learner.ends == windows.end[:5].tolist()
    assert seen == [(i, windows.end[i], windows.end[i]) for i in range(5)]
    passing.finish()
    assert len(learner.ends) == len(windows)
    with pytest.raises(ValueError, match="is gone"):
        passing.posterior(5)


def test_at_another_pace_nothing_is_learned_that_ends_later(windows: WindowSet) -> None:
    short = collect_windows(windows.drive, 0.4, Settings().rules())
    learner = LastEnd()
    passing = CausalPass(learner, short, pace=windows)
    for count in (0, 1, 7, len(windows)):
        passing.posterior(count)
        ended = windows.end[count - 1] if count else -np.inf
        assert passing.learned == np.sum(short.end <= ended + 1e-9)
    assert passing.finish().weights[0] == learner.ends[-1]

# SPDX-License-Identifier: Apache-2.0
"""Each candidate predicts a window from what it knew before, and learns it then."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.drive import WindowSet, prepare_drive
from slipwise.calibration.learner import BASELINE, CASCADE, DIRECT, make_learner
from slipwise.calibration.plain import plain_forecaster
from slipwise.calibration.structure_candidates import (
    BaselineCandidate,
    Candidate,
    cascade_candidate,
    direct_candidate,
)

SETTINGS = Settings()


@pytest.fixture(scope="module")
def windows() -> WindowSet:
    log = simulated_log(Drive(seconds=60.0, lag=0.3, delay=0.1))
    return learning_windows(prepare_drive(log, "command"), "command", SETTINGS)


def candidate_of(structure: int, windows: WindowSet) -> Candidate:
    learner = make_learner(SETTINGS, "command")
    if structure == DIRECT:
        learner = make_learner(
            Settings(basis="edd-2"), "command"
        )  # of several, the update is of the heaviest
        return direct_candidate(learner, windows)
    if structure == CASCADE:
        return cascade_candidate(windows, SETTINGS)
    return BaselineCandidate(windows, SETTINGS, tuple(basis.name for basis in learner.bases))


@pytest.mark.parametrize("structure", [DIRECT, CASCADE, BASELINE])
def test_a_prediction_is_made_before_its_window_is_learned(windows: WindowSet, structure: int) -> None:
    candidate = candidate_of(structure, windows)
    for i in range(6):
        belief = candidate.belief()
        path = _core.integrate_segment(
            belief.motion, belief.mean, windows.track(i), windows.segments[i], _core.Integrator.Exact
        )
        moved = np.asarray(path.sensor_poses[-1])
        predicted = candidate.predict(i, active=True)
        missed = windows.measured[i] - moved
        np.testing.assert_allclose(predicted.innovation[:2], missed[:2], atol=1e-9)
        assert np.exp(1j * predicted.innovation[2]) == pytest.approx(np.exp(1j * missed[2]))
        candidate.learn(i + 1)
    assert candidate.belief().structure == structure


def test_the_baseline_is_the_method_none_with_noise_that_is_learned(windows: WindowSet) -> None:
    baseline = candidate_of(BASELINE, windows)
    none = plain_forecaster(SETTINGS).belief(0)
    before = baseline.belief()
    assert before.motion.size == none.motion.size == 0
    assert before.weights.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    for i in range(6):
        baseline.predict(i, active=True)
    assert not np.allclose(baseline.belief().noise_scale, before.noise_scale)


def test_delays_alone_have_no_lag(windows: WindowSet) -> None:
    direct = candidate_of(DIRECT, windows)
    for i in range(6):
        direct.predict(i, active=True)
    belief = direct.belief()
    chain = belief.motion.chain(belief.mean)
    assert (chain.lag_v, chain.lag_omega) == (0.0, 0.0)
    assert chain.delay_v > 0.05


def test_delays_alone_are_learned_with_few_bases_whose_weights_stand_among_those_of_all(
    windows: WindowSet,
) -> None:
    learner = make_learner(SETTINGS, "command")
    weights = direct_candidate(learner, windows).belief().weights
    names = [basis.name for basis in learner.bases]
    used = {name for name, weight in zip(names, weights.tolist(), strict=True) if weight > 0.0}
    assert used == {"none", "edd-2", "odd-even-10"}
    assert weights.sum() == pytest.approx(1.0)

# SPDX-License-Identifier: Apache-2.0
"""Scores are over the second half of the windows, and relative to the baseline that is handed in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise.calibration.settings import Settings
from slipwise.evaluation.evaluate import EvaluationOptions, contest_of
from slipwise.evaluation.methods import method_info
from slipwise.evaluation.scoring import scores_of


def test_only_the_second_half_counts() -> None:
    log = simulated_log(Drive(seconds=40.0))
    contest, _ = contest_of(log, "command", Settings(), EvaluationOptions((2.0,)))
    (none,) = method_info("none").predict("none", contest)
    worse = none.pose.copy()
    worse[: len(none) // 2] += 100.0  # not judged
    worse[len(none) // 2 :] = none.measured[len(none) // 2 :] + np.array([0.3, 0.4, 0.0])
    other = replace(none, method="other", pose=worse)
    (score,) = scores_of([other], {2.0: none}, contest.targets)
    assert score.windows == len(none) - len(none) // 2
    np.testing.assert_allclose(score.position.mean, 0.5)
    expected = 0.5 / none.position_error[len(none) // 2 :].mean()
    np.testing.assert_allclose(score.position_ratio[0], expected)

# SPDX-License-Identifier: Apache-2.0
"""The average of bases is as good as the best of them, and near doing nothing while there is little data."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from sample_logs import PLAIN, Drive, simulated_log

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.learning_tables import AUTO_BASES
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import Log

TRUTHS = {
    "none": (),
    "edd-2": (-0.08, -0.35),
    "full-linear-6": (-0.1, 0.02, 0.03, 0.05, 0.02, -0.3),
    "odd-even-10": (-0.08, -0.05, 0.02, 0.05, -0.04, 0.03, -0.3, 0.02, 0.05, 0.01),
}


def basis_of(truth: str) -> _core.Basis:
    return PLAIN if truth == "none" else _core.named_basis(truth)


@cache
def errors(truth: str) -> dict[str, np.ndarray]:
    """Mean position and heading error after 5 s, of every basis and of their average."""
    options = EvaluationOptions(methods=(*AUTO_BASES, "auto"), horizons=(5.0,))
    drive = Drive(seconds=240.0, seed=3, basis=basis_of(truth), alpha=TRUTHS[truth])
    result = evaluate(simulated_log(drive), input="wheel", options=options)
    return {score.method: np.array((score.position.mean, score.heading.mean)) for score in result.scores}


def test_auto_is_near_the_best_basis_whatever_the_truth() -> None:
    for truth in TRUTHS:
        best = np.min([errors(truth)[basis] for basis in AUTO_BASES], axis=0)
        assert (errors(truth)["auto"] <= 1.15 * best).all(), truth


def test_auto_is_as_good_as_the_best_basis_over_all_truths() -> None:
    ratios = [errors(t)["auto"] / np.min([errors(t)[b] for b in AUTO_BASES], axis=0) for t in TRUTHS]
    assert np.exp(np.mean(np.log(ratios))) <= 1.05


def test_no_fixed_basis_is_as_good_as_auto_over_all_truths() -> None:
    def mean_log(method: str) -> float:
        return float(np.mean([np.log(errors(truth)[method]) for truth in TRUTHS]))

    assert mean_log("auto") < min(mean_log(basis) for basis in AUTO_BASES)


def test_weights_sum_to_one_after_every_window() -> None:
    drive = Drive(seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(-0.02, -0.03))
    history = calibrate(simulated_log(drive), input="wheel").history
    assert history is not None
    assert history.bases == AUTO_BASES
    assert history.basis_weight.sum(axis=1) == pytest.approx(np.ones(len(history.t)))
    assert (history.basis_weight > 0.0).all()


def test_weight_goes_to_the_true_basis() -> None:
    drive = Drive(seconds=240.0, seed=3, basis=basis_of("odd-even-10"), alpha=TRUTHS["odd-even-10"])
    history = calibrate(simulated_log(drive), input="wheel").history
    assert history is not None
    assert history.bases[int(np.argmax(history.basis_weight[-1]))] == "odd-even-10"
    assert history.basis_weight[-20:, history.bases.index("none")].max() < 0.01


def test_little_data_leaves_the_kinematic_baseline() -> None:
    content = calibrate(two_windows(), input="wheel").model.content
    assert content.weights["none"] == 1.0
    assert content.parameters == []
    assert not content.verdict.good


def two_windows() -> Log:
    """Of a robot that slips half its turn."""
    return simulated_log(Drive(seconds=2.2, basis=basis_of("edd-2"), alpha=(0.0, -0.5)))


def test_little_data_leaves_the_average_of_bases_near_the_baseline() -> None:
    """The model moves towards the slip, and is not sure."""
    settings = make_settings({"auto": {"structures": ["joint"]}})
    content = calibrate(two_windows(), input="wheel", settings=settings).model.content
    assert content.parameters
    off = [p.value - (np.log(0.018) if p.name.startswith("log_") else 0.0) for p in content.parameters]
    assert all(abs(each) <= 2.0 * p.prior_std for each, p in zip(off, content.parameters, strict=True))
    assert max(content.weights.values()) < 0.5
    assert not content.verdict.good


def test_fixed_basis_has_all_the_weight() -> None:
    history = calibrate(
        simulated_log(Drive(seconds=30.0)), input="wheel", settings=make_settings({"basis": "edd-2"})
    ).history
    assert history is not None
    assert history.bases == ("edd-2",)
    assert history.basis_weight.tolist() == [[1.0]] * len(history.t)

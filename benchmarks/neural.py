# SPDX-License-Identifier: Apache-2.0
"""Neural networks as causal methods: a forward model, or a correction of what auto predicts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from network import Network, NetworkOptions, fit_network, regressor_class
from numpy.typing import NDArray
from window_inputs import beside, chords, poses_of, unwrapped_motion, window_inputs

from slipwise.calibration.learner import JOINT
from slipwise.calibration.plain import baseline_predictor
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.predictors import ProposedPoses, known_windows, predict_all, scored_predictions
from slipwise.calibration.prepared_run import WindowSet
from slipwise.evaluation.methods import Contest, MethodInfo, add_method, learned

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST, GROWTH = 12, 1.5  # examples of the first fit, and their growth from one fit to the next
MOST = 2000  # the latest examples are fitted to
_FORWARD = NetworkOptions()
_CORRECTION = NetworkOptions(may_abstain=True)


@dataclass(frozen=True, eq=False)
class _Task:
    """A regression from what is known at each window's start, and when each example is known, [N] each."""

    inputs: Floats  # [N, D]
    outputs: Floats  # [N, 3] chords
    known: Ints  # examples that had ended one horizon before the window
    options: NetworkOptions


@dataclass(frozen=True, eq=False)
class _Outputs:
    """What the networks said, in the order of the windows."""

    causal: Floats  # [N, 3] before the window was learned
    in_sample: Floats  # [N, 3] by the first fit that had learned it
    fitted: NDArray[np.bool_]  # [N] whether there was a network yet
    spread: Floats  # [N, 3, 3] second moment of the errors on the last quarter of the examples


def add_networks() -> None:
    """Let evaluations of this process compare `neural` and `neural-residual`."""
    add_method("neural", MethodInfo(_forward, "networks from inputs to motion, fitted again as windows come"))
    add_method("neural-residual", MethodInfo(_residual, "networks that correct the predictions of auto"))


def _forward(_: str, contest: Contest) -> tuple[Predictions, ...]:
    baseline = predict_all(baseline_predictor(contest.settings), contest.windows, contest.targets)
    return tuple(neural(*pair) for pair in zip(contest.targets, baseline, strict=True))


def _residual(_: str, contest: Contest) -> tuple[Predictions, ...]:
    own = learned("auto", contest)
    return tuple(neural_residual(*pair) for pair in zip(contest.targets, own, strict=True))


def neural(targets: WindowSet, baseline: Predictions) -> Predictions:
    """Predict by networks that learned the earlier windows; as the kinematic baseline until the first fit.

    The wheel speeds at the start of a window are the last thing measured that its prediction uses.

    Args:
        targets: the windows to predict, which are the examples too.
        baseline: the kinematic baseline's predictions of them.

    Raises:
        SettingsError: scikit-learn is missing.
    """
    regressor_class()
    moved, known = chords(unwrapped_motion(targets)), known_windows(targets)
    inputs = np.hstack((window_inputs(targets), last_known(moved - chords(baseline.pose), known)))
    found = _predicted(_Task(inputs, moved, known, _FORWARD))
    pose = np.where(found.fitted[:, None], poses_of(found.causal), baseline.pose)
    covariance = np.where(
        found.fitted[:, None, None],
        _turned_covariance(found.spread, pose[:, 2]),
        baseline.covariance / baseline.inflation[:, None, None],
    )
    proposed = ProposedPoses(
        pose, covariance, poses_of(found.in_sample), np.full(len(targets), JOINT, dtype=np.int64)
    )
    return scored_predictions("neural", targets, proposed, targets.start)


def neural_residual(targets: WindowSet, own: Predictions) -> Predictions:
    """Correct slipwise's predictions by networks that learned its earlier errors, where that helps.

    The covariance is that of `own`, inflated by what was learned from the errors after correction.

    Args:
        targets: the windows to predict, which are the examples too.
        own: slipwise's predictions of them.

    Raises:
        SettingsError: scikit-learn is missing.
    """
    regressor_class()
    known, predicted = known_windows(targets), chords(own.pose)
    left = chords(beside(targets.measured, own.pose[:, 2])) - predicted
    inputs = np.hstack((window_inputs(targets), predicted, last_known(left, known)))
    found = _predicted(_Task(inputs, left, known, _CORRECTION))
    proposed = ProposedPoses(
        poses_of(predicted + found.causal),
        own.covariance / own.inflation[:, None, None],
        poses_of(predicted + found.in_sample),
        own.structure,
    )
    return scored_predictions("neural-residual", targets, proposed, targets.start)


def last_known(rows: Floats, known: Ints) -> Floats:
    """Return the last of `rows` [N, K] that each window knows, zeros before the first, [N, K]."""
    found = rows[np.maximum(known - 1, 0)]
    found[known == 0] = 0.0
    return np.asarray(found)


def _predicted(task: _Task) -> _Outputs:
    """Fit again whenever the examples have grown by half, and predict up to the next fit."""
    size = len(task.outputs)
    causal, in_sample = np.zeros((size, 3)), np.zeros((size, 3))
    fitted, spread = np.zeros(size, dtype=np.bool_), np.zeros((size, 3, 3))
    learned = 0
    for count, network in _networks(task):
        in_sample[learned:count] = network.predict(task.inputs[learned:count])
        learned = count
        later = task.known >= count
        causal[later], fitted[later] = network.predict(task.inputs[later]), True
        spread[later] = _second_moment(network)
    return _Outputs(causal, in_sample, fitted, spread)


def _networks(task: _Task) -> Iterator[tuple[int, Network]]:
    """Yield the number of examples and the network of each fit; the last has all, and predicts nothing."""
    for count in (*_fit_counts(task.known), len(task.outputs)):
        first = max(count - MOST, 0)
        if count - first >= 4:  # a last quarter and something before it
            yield count, fit_network(task.inputs[first:count], task.outputs[first:count], task.options)


def _fit_counts(known: Ints) -> list[int]:
    """After how many examples a network is fitted: none of its own time is waited for."""
    counts, due = [], FIRST
    for count in np.unique(known).tolist():
        if count >= due:
            counts.append(count)
            due = math.ceil(GROWTH * count)
    return counts


def _second_moment(network: Network) -> Floats:
    """The covariance [3, 3] of what is predicted, never flat: few errors span few directions."""
    errors = network.validation
    moment = errors.T @ errors / len(errors)
    return np.asarray(0.9 * moment + 0.1 * np.diag(np.diag(moment)) + 1e-12 * np.eye(3))


def _turned_covariance(covariance: Floats, heading: Floats) -> Floats:
    """Turn covariances [N, 3, 3] of chords by half the heading, without its own lever."""
    c, s = np.cos(0.5 * heading), np.sin(0.5 * heading)
    turn = np.zeros((len(heading), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    return np.asarray(turn @ covariance @ turn.transpose(0, 2, 1))

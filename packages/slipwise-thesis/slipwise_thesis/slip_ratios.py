# SPDX-License-Identifier: Apache-2.0
"""Peer methods with slip ratios and a slip angle, learned causally by an EKF or a sliding-mode observer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictors import Predictor
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.settings import Settings
from slipwise.errors import SettingsError
from slipwise_thesis import _thesis

SIZE = 6  # parameters of full-linear-6, in which both predict


UpdateT = TypeVar("UpdateT")


@dataclass(frozen=True)
class SlipRatioEstimator(Generic[UpdateT]):
    """An estimator of slip ratios: how it learns a window, and what it believes now."""

    learn: Callable[[_core.InputHistory, _core.Segment], UpdateT]
    posterior: Callable[[], Posterior]


def slip_ratio_filter(input_name: str, settings: Settings, windows: WindowSet) -> Predictor:
    """`slip-ratio-ekf`: predictions carry the filter's covariance and the noise shape.

    Raises:
        SettingsError: the input is not wheel speeds.
    """
    name = "slip-ratio-ekf"
    _refuse_commands(name, input_name)
    table = _thesis.SlipRatioFilterSettings()
    table.wheel_separation, table.huber = settings.wheel_separation, settings.filter.huber
    table.noise = settings.filter_settings().noise.shape
    estimator = _thesis.SlipRatioFilter(table)

    def posterior() -> Posterior:
        linear = estimator.linear_estimate()
        return _posterior(np.array(linear.mean), np.array(linear.covariance))

    return _predictor(name, settings, SlipRatioEstimator(estimator.learn, posterior), windows)


def slip_ratio_observer(input_name: str, settings: Settings, windows: WindowSet) -> Predictor:
    """`slip-ratio-smo`: an observer has no covariance, so that predictions carry the noise shape alone.

    Raises:
        SettingsError: the input is not wheel speeds.
    """
    name = "slip-ratio-smo"
    _refuse_commands(name, input_name)
    table = _thesis.SlidingModeSettings()
    table.wheel_separation = settings.wheel_separation
    estimator = _thesis.SlidingModeObserver(table)

    def posterior() -> Posterior:
        return _posterior(np.array(estimator.linear_mean()), np.zeros((SIZE, SIZE)))

    return _predictor(name, settings, SlipRatioEstimator(estimator.learn, posterior), windows)


def _refuse_commands(name: str, input_name: str) -> None:
    if input_name != "wheel":
        raise SettingsError(
            f"the method {name} learns slip between wheels and terrain, and needs wheel speeds",
            where="--methods",
            advice="give --input wheel, or leave the method out",
        )


def _posterior(mean: np.ndarray, covariance: np.ndarray) -> Posterior:
    ones = np.ones(SIZE)
    return Posterior(_thesis.slip_ratio_model(), mean, covariance, np.ones(3), ones, ones, np.ones(1))


def _predictor(
    name: str, settings: Settings, estimator: SlipRatioEstimator[UpdateT], windows: WindowSet
) -> Predictor:
    shape = settings.filter_settings().noise.shape
    return Predictor(name, shape, CausalPass(estimator, windows).posterior, False)

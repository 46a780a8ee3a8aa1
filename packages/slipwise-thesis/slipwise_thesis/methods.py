# SPDX-License-Identifier: Apache-2.0
"""Slip ratios and slip surfaces as methods of `slipwise evaluate`."""

from __future__ import annotations

from slipwise.calibration.predictors import Predictor
from slipwise.evaluation.methods import Contest, MethodInfo, by
from slipwise_thesis.slip_ratios import slip_ratio_filter, slip_ratio_observer
from slipwise_thesis.slip_surfaces import surface_predictor


def _surface(name: str, contest: Contest) -> Predictor:
    return surface_predictor(name, contest.input_name, contest.settings, contest.windows)


SLIP_RATIO_EKF = MethodInfo(
    by(lambda _, c: slip_ratio_filter(c.input_name, c.settings, c.windows)),
    "slip ratios and slip angle (thesis 2.5 to 2.7) by an EKF, from wheel speeds",
)
SLIP_RATIO_SMO = MethodInfo(
    by(lambda _, c: slip_ratio_observer(c.input_name, c.settings, c.windows)),
    "the same by a sliding-mode observer; its covariance is the noise shape alone",
)
SURFACE_LEAST_SQUARES = MethodInfo(by(_surface), "slip surface by least squares (thesis 5.5)")
SURFACE_GAUSSIAN_PROCESS = MethodInfo(
    by(_surface), "slip surface by a Gaussian process (thesis Table 5.1), as terms of the settings' basis"
)
SURFACE_BAYESIAN = MethodInfo(by(_surface), "slip surface by Bayesian linear regression (thesis 5.13)")

# SPDX-License-Identifier: Apache-2.0
"""The methods that an evaluation compares, each turned into a forecaster."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.calibration.batch import fit_batch
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.estimator_pass import EstimatorPass, estimator_motion
from slipwise.calibration.forecast import Forecaster
from slipwise.calibration.learner import make_learner
from slipwise.calibration.plain import model_forecaster, plain_forecaster, vendor_forecaster
from slipwise.calibration.settings import Settings
from slipwise.calibration.structure_choice import learning_pass
from slipwise.errors import SettingsError
from slipwise.evaluation.slip_ratios import slip_ratio_filter, slip_ratio_observer
from slipwise.evaluation.slip_surfaces import surface_forecaster
from slipwise.models.model import Model

BATCH_BASIS = "odd-even-10"


@dataclass(frozen=True, eq=False)
class Contest:
    """What all methods are given."""

    input_name: str
    settings: Settings
    windows: WindowSet  # to learn from
    targets: tuple[WindowSet, ...]  # to predict, one set per horizon
    vendor_track_multiplier: float | None = None
    model: Model | None = None


@dataclass(frozen=True)
class MethodInfo:
    """How a method is made."""

    make: Callable[[str, Contest], Forecaster]
    description: str


def method_names(contest: Contest) -> tuple[str, ...]:
    """Return the methods compared where none are named: all that the contest allows but single estimators."""
    names = ["none"]
    if contest.vendor_track_multiplier is not None:
        names.append("vendor")
    names += [*_core.basis_names(), "batch"]
    if contest.model is not None:
        names.append("model")
    if contest.settings.basis == "custom":
        names.append("custom")
    return (*names, "auto")


def method_info(name: str) -> MethodInfo:
    """Return how the method is made.

    Raises:
        SettingsError: there is no such method.
    """
    special = {
        "none": MethodInfo(lambda _, c: plain_forecaster(c.settings), "the plain model: no slip, no lag"),
        "vendor": MethodInfo(_vendor, "a vendor's wheel-separation multiplier"),
        "batch": MethodInfo(
            _batch, f"one fit of {BATCH_BASIS} over the whole log, the windows judged included"
        ),
        "model": MethodInfo(_model, "the model file as it is"),
        "auto": MethodInfo(_learned, "average of several bases by how well they predict"),
        "slip-ratio-ekf": MethodInfo(
            lambda _, c: slip_ratio_filter(c.input_name, c.settings, c.windows),
            "slip ratios and slip angle (thesis 2.5 to 2.7) by an EKF, from wheel speeds",
        ),
        "slip-ratio-smo": MethodInfo(
            lambda _, c: slip_ratio_observer(c.input_name, c.settings, c.windows),
            "the same by a sliding-mode observer; its covariance is the noise shape alone",
        ),
        "surface-least-squares": MethodInfo(_surface, "slip surface by least squares (thesis 5.5)"),
        "surface-gaussian-process": MethodInfo(
            _surface, "slip surface by a Gaussian process (thesis Table 5.1), as terms of the settings' basis"
        ),
        "surface-bayesian": MethodInfo(_surface, "slip surface by Bayesian linear regression (thesis 5.13)"),
        "custom": MethodInfo(_learned, "the terms of the settings file"),
    }
    if name in special:
        return special[name]
    if name in _core.basis_names():
        return MethodInfo(_learned, f"the basis {name}, learned causally")
    if name in _core.estimator_names():
        return MethodInfo(_estimator, f"the estimator {name} with the basis of the settings")
    known = ", ".join([*special, *_core.basis_names(), *_core.estimator_names()])
    raise SettingsError(f"unknown method '{name}'", where="--methods", advice=f"known are {known}")


def _learned(name: str, contest: Contest) -> Forecaster:
    settings = contest.settings.model_copy(update={"basis": name})
    learner = make_learner(settings, contest.input_name)
    average = learner.fresh()
    shape = settings.filter_settings().noise.shape
    passing = learning_pass(average, contest.windows, settings)
    return Forecaster(name, average.model, shape, passing.belief, learner.dynamics)


def _estimator(name: str, contest: Contest) -> Forecaster:
    motion = estimator_motion(name, contest.settings, contest.input_name)
    passing = EstimatorPass(name, motion, contest.settings, contest.windows)
    shape = contest.settings.filter_settings().noise.shape
    return Forecaster(name, motion, shape, passing.belief, motion.dynamics)


def _surface(name: str, contest: Contest) -> Forecaster:
    return surface_forecaster(name, contest.input_name, contest.settings, contest.windows)


def _vendor(name: str, contest: Contest) -> Forecaster:
    if contest.vendor_track_multiplier is None:
        raise SettingsError(
            f"the method {name} needs a multiplier",
            where="--methods",
            advice="give --vendor-track-multiplier, such as 1.875",
        )
    return vendor_forecaster(contest.vendor_track_multiplier, contest.settings)


def _model(name: str, contest: Contest) -> Forecaster:
    if contest.model is None:
        raise SettingsError(
            f"the method {name} needs a model file", where="--methods", advice="give --model FILE"
        )
    return model_forecaster(contest.model, contest.windows.drive)


def _batch(name: str, contest: Contest) -> Forecaster:
    learner = make_learner(contest.settings.model_copy(update={"basis": BATCH_BASIS}), contest.input_name)
    average = learner.fresh()
    last = CausalPass(average, contest.windows).finish()
    shape = contest.settings.filter_settings().noise.shape
    belief = fit_batch(
        average.model,
        contest.windows,
        learner.settings,
        (shape, np.array(last.noise_scale)),
        average.reference_speeds,
    )
    return Forecaster(name, average.model, shape, lambda _: belief, learner.dynamics, causal=False)

# SPDX-License-Identifier: Apache-2.0
"""The slip surfaces of thesis chapter 5 as causal methods: each window is an example of slip rates."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictors import Predictor
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.settings import Settings
from slipwise_thesis.estimators import estimator_basis, learned_parts
from slipwise_thesis.surfaces import (
    BasisSlip,
    BayesianOptions,
    BayesianSurface,
    GaussianProcessOptions,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipExamples,
    project_on_basis,
)
from slipwise_thesis.surfaces.gaussian_process import require_scikit_learn, spread_out
from slipwise_thesis.window_examples import window_examples

Floats = NDArray[np.float64]

CHAIN_BASIS = "edd-2"  # its filter gives lag, delay and clock offset, which surfaces have none of
LARGEST_PROCESS = 200  # examples of a Gaussian process, O(N^3)
SHAPING = 60  # examples that its kernel is shaped by
UNDRIVEN = (0.05, 0.05)  # m/s, rad/s: reference speeds of the prior before the first example
#: Examples grow by this factor from one fit to the next; the Bayesian surface also learns in between.
INFLATION = {"surface-least-squares": 1.1, "surface-gaussian-process": 2.0, "surface-bayesian": 2.0}

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SurfaceRules:
    """What a surface is made of."""

    method: str
    motion: _core.MotionModel  # the terms behind lag, delay and clock offset
    slip_fraction: float  # of the motion that a term may explain before any example
    noise: _core.MotionNoise  # its pose noise holds beside the surface's own slip noise


def surface_predictor(name: str, input_name: str, settings: Settings, windows: WindowSet) -> Predictor:
    """Return a slip surface at work, behind the lag, delay and clock offset that `edd-2` has learned so far.

    Raises:
        SettingsError: a basis is unknown, or scikit-learn is missing.
    """
    dynamics, offset = learned_parts(settings, input_name)
    basis = settings.model_copy(update={"basis": estimator_basis(settings)}).bases()[0]
    motion = _core.MotionModel(basis, dynamics, offset).with_extrinsics(settings.sensor_extrinsics.learn)
    actuator = _core.ModelAverage(
        CHAIN_BASIS,
        [_core.named_basis(CHAIN_BASIS)],
        dynamics,
        offset,
        settings.sensor_extrinsics.learn,
        settings.filter_settings(),
        _core.ModelAverageSettings(),
    )
    shape = settings.filter_settings().noise.shape
    rules = SurfaceRules(name, motion, settings.prior.slip_fraction, shape)
    if name == "surface-gaussian-process":
        require_scikit_learn()
    return Predictor(name, shape, SurfacePass(rules, actuator, windows).posterior, dynamics)


class _ActuatorLearner:
    """The filter of the basis that gives lag, delay and offset."""

    def __init__(self, actuator: _core.ModelAverage) -> None:
        self._actuator, self._motion = actuator, actuator.model

    def learn(self, inputs: _core.InputHistory, segment: _core.Segment) -> _core.IekfUpdate:
        """Learn one window."""
        return self._actuator.learn(inputs, segment)

    def posterior(self) -> Posterior:
        """Return the present estimate."""
        state = self._actuator.state()
        return Posterior(
            motion=self._motion,
            mean=np.array(state.estimate.mean),
            covariance=np.array(state.estimate.covariance),
            noise_scale=np.array(state.noise_scale),
            prior_std=np.array(state.prior_std),
            variance_ratio=np.array(state.variance_ratio),
            weights=np.array(state.weights),
        )


class SurfacePass:
    """Learns windows in order, only as far as it is asked to.

    At each fit, all are made again from the windows with what is then known of lag, delay and offset.
    """

    def __init__(self, rules: SurfaceRules, actuator: _core.ModelAverage, windows: WindowSet) -> None:
        """`actuator` has learned nothing yet; it gives lag, delay and offset, and tells slip from curves."""
        self._rules, self._windows = rules, windows
        self._actuator = CausalPass(_ActuatorLearner(actuator), windows, self._learn)
        self._weight = np.zeros(len(windows))
        self._actuator_start = actuator.model.slip_size
        self._reference = actuator.model
        self._regression = SurfaceRegression(rules)

    def posterior(self, count: int) -> Posterior:
        """Return the posterior after `count` windows.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        return self._joined(self._actuator.posterior(count))

    def _learn(self, i: int, update: _core.IekfUpdate, actuator: Posterior) -> None:
        """Learn window i, unless the filter of the actuator left it out as an outlier."""
        self._weight[i] = update.weight
        if update.weight == 0.0:
            return
        if self._regression.due:
            places = np.flatnonzero(self._weight[: i + 1] > 0.0)
            self._regression.relearn(self._examples(actuator, places))
        else:
            self._regression.learn(self._examples(actuator, np.array([i])))

    def _examples(self, actuator: Posterior, places: NDArray[np.int64]) -> SlipExamples | None:
        return window_examples((self._reference, actuator.mean), self._windows, places)

    def _joined(self, actuator: Posterior) -> Posterior:
        """Put the surface before the actuator's parameters; the two are taken as independent."""
        slip, start = self._regression.slip, self._actuator_start
        size = len(slip.alpha)
        covariance = np.zeros((self._rules.motion.size, self._rules.motion.size))
        covariance[:size, :size] = slip.covariance
        covariance[size:, size:] = actuator.covariance[start:, start:]
        prior_std = np.concatenate((slip.prior_std, actuator.prior_std[start:]))
        variance = np.square(slip.noise_std) + np.square(slip.projection_rms)
        noise = self._slip_noise(variance * self._windows.length) if self._regression.fitted else None
        return Posterior(
            motion=self._rules.motion,
            mean=np.concatenate((slip.alpha, actuator.mean[start:])),
            covariance=covariance,
            noise_scale=np.ones(3),
            prior_std=prior_std,
            variance_ratio=np.diag(covariance) / prior_std**2,
            weights=np.ones(1),
            noise=noise,
        )

    def _slip_noise(self, density: Floats) -> _core.MotionNoise:
        """White slip noise of this density [3], and the pose noise of the settings."""
        poses = self._rules.noise
        return _core.MotionNoise(
            density.tolist(), [0.0] * 3, [0.0] * 3, poses.pose_std_xy, poses.pose_std_yaw
        )


class SurfaceRegression:
    """One kind of surface over the examples so far, fitted again at times, as parameters of a basis."""

    def __init__(self, rules: SurfaceRules) -> None:
        """Start with no slip, as sure as the prior is."""
        self._rules, self._basis = rules, rules.motion.basis
        self._count, self._next_fit = 0, 1
        self._surface: LeastSquaresSurface | GaussianProcessSurface | BayesianSurface | None = None
        self._said = False
        self.slip = self._nothing(UNDRIVEN)

    @property
    def due(self) -> bool:
        """Whether the next example is for `relearn`."""
        return self._count + 1 >= self._next_fit

    @property
    def fitted(self) -> bool:
        """Whether `slip` comes from examples."""
        return self._surface is not None

    def learn(self, example: SlipExamples | None) -> None:
        """Count one more example; the Bayesian surface learns it."""
        if example is None:
            return
        self._count += len(example)
        if isinstance(self._surface, BayesianSurface):
            self._surface.update(example)
            self.slip = self._surface.basis_slip()

    def relearn(self, examples: SlipExamples | None) -> None:
        """Fit the surface to these examples alone."""
        if examples is None:
            return
        self._count = len(examples)
        self._next_fit = max(self._count + 1, math.ceil(self._count * INFLATION[self._rules.method]))
        self.slip = self._fit(examples)

    def _fit(self, examples: SlipExamples) -> BasisSlip:
        prior = self._prior_std(examples.reference)
        if self._rules.method == "surface-bayesian":
            bayesian = BayesianSurface(
                self._basis, options=BayesianOptions(slip_fraction=self._rules.slip_fraction)
            )
            bayesian.fit(examples)
            self._surface = bayesian
            return bayesian.basis_slip()
        if len(examples) <= max(len(self._basis.lon), len(self._basis.lat), len(self._basis.ang)):
            return self._nothing(examples.reference)  # too few to see noise beside the terms
        if self._rules.method == "surface-least-squares":
            squares = LeastSquaresSurface(self._basis)
            squares.fit(examples)
            self._surface = squares
            return squares.basis_slip(prior_std=prior)
        process = GaussianProcessSurface(
            options=GaussianProcessOptions(largest=LARGEST_PROCESS, shaped_by=SHAPING)
        )
        process.fit(self._thinned(examples))
        self._surface = process
        return project_on_basis(process, self._basis, prior_std=prior)

    def _thinned(self, examples: SlipExamples) -> SlipExamples:
        """Return at most as many examples as a Gaussian process takes here, spread over the drives."""
        if len(examples) <= LARGEST_PROCESS:
            return examples
        if not self._said:
            _log.warning("%s keeps %d examples, spread over the drives", self._rules.method, LARGEST_PROCESS)
            self._said = True
        drives = np.column_stack((examples.v, examples.omega)) / examples.reference
        return examples[spread_out(drives, LARGEST_PROCESS)]

    def _nothing(self, reference: tuple[float, float]) -> BasisSlip:
        prior = self._prior_std(reference)
        return BasisSlip(self._basis, np.zeros(len(prior)), np.diag(prior**2), prior, np.zeros(3))

    def _prior_std(self, reference: tuple[float, float]) -> Floats:
        std = _core.slip_prior_std(self._basis, *reference, self._rules.slip_fraction)
        return np.asarray(std, dtype=np.float64)

# SPDX-License-Identifier: Apache-2.0
"""The methods that an evaluation compares, and the predictions of each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace

from slipwise import _core, plugins
from slipwise.calibration.estimator_run import estimator_info
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.plain import baseline_predictor, model_predictor, vendor_predictor
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.predictors import Predictor, predict_all
from slipwise.calibration.prepared_run import WindowSet, collect_windows
from slipwise.calibration.settings import AVERAGE, Settings, sensor_of
from slipwise.calibration.settings_for_log import SIDEWAYS_BASES, SLOPE_BASES
from slipwise.errors import SettingsError, SlipwiseError
from slipwise.models.model import Model
from slipwise.segments import car_prior


@dataclass(frozen=True, eq=False)
class Contest:
    """What all methods are given."""

    input_name: str
    settings: Settings
    windows: WindowSet  # to learn from
    targets: tuple[WindowSet, ...]  # to predict, one set per horizon
    vendor_wheel_separation_multiplier: float | None = None
    models: Mapping[str, Model] = field(default_factory=dict)  # model files as they are, by method
    learned_from_this: frozenset[str] = frozenset()  # those of them that were learned from this very log
    embargo: float | None = None  # s before a prediction from which nothing is learned; None: one horizon


@dataclass(frozen=True)
class MethodInfo:
    """How a method predicts."""

    predict: Callable[[str, Contest], tuple[Predictions, ...]]  # one for each set of targets
    description: str


BOUND = "batch"  # the estimator that has seen the whole log
_ADDED: dict[str, MethodInfo] = {}


def add_method(name: str, info: MethodInfo) -> None:
    """Let evaluations of this process compare one method more, by its name."""
    _ADDED[name] = info


def method_names(contest: Contest) -> tuple[str, ...]:
    """Return the methods compared where none are named: all that the contest allows but single estimators."""
    names = ["none"]
    if contest.vendor_wheel_separation_multiplier is not None:
        names.append("vendor")
    # Where the ground is level, or nothing drives sideways.
    left_out = {*SLOPE_BASES, *SIDEWAYS_BASES} - set(contest.settings.auto.bases)
    names += [name for name in _core.basis_names() if name not in left_out]
    names += [BOUND] if BOUND in plugins.added(plugins.ESTIMATORS) else []
    names += contest.models
    if contest.settings.basis == "custom":
        names.append("custom")
    if contest.settings.estimator not in (AVERAGE, *names):
        names.append(contest.settings.estimator)
    return (*names, "auto")


def method_info(name: str, models: Collection[str] = ()) -> MethodInfo:
    """Return how the method predicts; `models` are the names of model files among the methods.

    Raises:
        SettingsError: there is no such method.
        SlipwiseError: it comes with a package that is not installed.
    """
    special = {
        "none": MethodInfo(_plain, "the kinematic baseline: no slip, no lag"),
        "vendor": MethodInfo(by(_vendor), "a vendor's wheel-separation multiplier"),
        "model": MethodInfo(_model, "the model file as it is"),
        "auto": MethodInfo(learned, "average of several bases by how well they predict"),
        "custom": MethodInfo(learned, "the terms of the settings file"),
        **_ADDED,
    }
    if name in models:
        return special["model"]
    if name in special:
        return special[name]
    if name in _core.basis_names():
        return MethodInfo(learned, f"the basis {name}, learned causally")
    estimators, methods = plugins.added(plugins.ESTIMATORS), plugins.added(plugins.METHODS)
    if name in methods:
        added: MethodInfo = plugins.load(plugins.METHODS, name)
        return added
    if name in estimators:
        off_line = ", fitted to the whole log, the windows judged included"
        about = off_line if estimator_info(name).off_line else ""
        return MethodInfo(by(_estimator), f"the estimator {name} with the basis of the settings{about}")
    for group in (plugins.METHODS, plugins.ESTIMATORS):
        plugins.refuse_missing(group, name)
    known = ", ".join([*special, *methods, *_core.basis_names(), *estimators])
    raise SettingsError(f"unknown method '{name}'", where="--methods", advice=f"known are {known}")


def refuse_names_of_methods(models: Collection[str]) -> None:
    """Raise SettingsError where a model file has the name of another method."""
    for name in set(models) - {"model"}:
        try:
            method_info(name)
        except SlipwiseError:
            continue
        raise SettingsError(
            f"a model has the name of the method {name}", where="model", advice="name it by its file"
        )


def by(make: Callable[[str, Contest], Predictor]) -> Callable[[str, Contest], tuple[Predictions, ...]]:
    """Predict with what `make` returns."""

    def predict(name: str, contest: Contest) -> tuple[Predictions, ...]:
        return predict_all(make(name, contest), contest.windows, contest.targets, contest.embargo)

    return predict


def learned(name: str, contest: Contest) -> tuple[Predictions, ...]:
    """Push the log through a learner with the basis `name`, which predicts on the way."""
    settings = contest.settings.model_copy(update={"basis": name, "estimator": AVERAGE})
    horizons = [targets.length for targets in contest.targets]
    learned = learn_log(contest.windows.drive, settings, horizons, embargo=contest.embargo)
    return tuple(replace(predictions, method=name) for predictions in learned.predictions)


def _driven_by(model: Model, contest: Contest) -> tuple[WindowSet, ...]:
    """Return the targets; throttle and steering go through the model's curves, not those learned meanwhile.

    Where the settings say nothing else, the pose sensor sits where the settings of the model say.

    Raises:
        SettingsError: the log has no throttle and steering.
    """
    rules, drive = contest.settings.rules(), contest.windows.drive
    if not any(rules.sensor):
        rules = replace(rules, sensor=sensor_of(model))
    if model.car is None and rules == contest.settings.rules():
        return contest.targets
    if model.car is not None and car_prior([run.run for run in drive]) is None:
        raise SettingsError(
            "the model takes throttle and steering, and the log has none",
            where="--model",
            advice="give --vehicle dart or another with throttle_steering, and columns throttle and steering",
        )
    return tuple(collect_windows(drive, targets.length, rules, model.car) for targets in contest.targets)


def _plain(_: str, contest: Contest) -> tuple[Predictions, ...]:
    """Predict by the input alone; throttle and steering by a bicycle with the best constant gains so far."""
    drive = contest.windows.drive
    if drive[0].input_name == "wheel" or car_prior([run.run for run in drive]) is None:
        predictor = baseline_predictor(contest.settings)
        return predict_all(predictor, contest.windows, contest.targets, contest.embargo)
    horizons = [targets.length for targets in contest.targets]
    return learn_log(drive, contest.settings, horizons, embargo=contest.embargo).baseline


def _estimator(name: str, contest: Contest) -> Predictor:
    settings = contest.settings.model_copy(update={"estimator": name})
    run = estimator_info(name).run(settings, contest.input_name, contest.windows)
    shape = settings.filter_settings().noise.shape
    if run.causal:
        return Predictor(name, shape, run.posterior, run.dynamics)
    kept = run.kept()
    return Predictor(name, shape, lambda _: kept, run.dynamics, causal=False)


def _vendor(name: str, contest: Contest) -> Predictor:
    if contest.vendor_wheel_separation_multiplier is None:
        raise SettingsError(
            f"the method {name} needs a multiplier",
            where="--methods",
            advice="give --vendor-wheel-separation-multiplier, such as 1.875",
        )
    return vendor_predictor(contest.vendor_wheel_separation_multiplier, contest.settings)


def _model(name: str, contest: Contest) -> tuple[Predictions, ...]:
    if name not in contest.models:
        raise SettingsError(
            f"the method {name} needs a model file", where="--methods", advice="give --model FILE"
        )
    model, causal = contest.models[name], name not in contest.learned_from_this
    predictor = replace(model_predictor(model), method=name, causal=causal)
    return predict_all(predictor, contest.windows, _driven_by(model, contest), contest.embargo)

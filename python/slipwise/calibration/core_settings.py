# SPDX-License-Identifier: Apache-2.0
"""Settings as the streaming learner of the core takes them."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise import _core
from slipwise.calibration.coming import Coming
from slipwise.calibration.learning_tables import AUTO_BASES
from slipwise.calibration.settings import Settings
from slipwise.calibration.settings_for_log import for_positions
from slipwise.calibration.source_tables import core_sources
from slipwise.errors import SettingsError
from slipwise.logs import LogOptions

NOTHING_PARTICULAR = Coming()
STRAIGHT_SIDE_SLIP = 0.03  # rad, standard deviation of a side slip that positions do not see

# What other terms would say, curves, drag of cornering and understeer say already.
_CAR_BASES = ("none", "edd-2")
_CAR_LAG, _CAR_DELAY = 0.03, 0.05  # s; medians of the rest behind the lags of a car


def core_settings(  # noqa: PLR0913 - six things, each of its own sort
    settings: Settings,
    input_name: str,
    horizons: Sequence[float],
    *,
    coming: Coming = NOTHING_PARTICULAR,
    remember: bool = False,
    car: _core.CarPrior | None = None,
    wheelbase: float | None = None,
) -> _core.LearnerSettings:
    """Return the core's settings.

    Args:
        settings: what to learn and how.
        input_name: "command" or "wheel".
        horizons: of the predictions that are held against what was measured [s].
        coming: what will be measured. Positions do not tell a side slip that is always the same.
        remember: keep surfaces that were driven on, and recall them.
        car: what is taken of a car whose commands are throttle and steering, before it drives.
        wheelbase: of a robot that is commanded to steer [m]: lags act on its steering.

    Raises:
        SettingsError: a basis or a term is unknown, a force is to be learned beside surfaces, or settings
            name a source that is not among them.
    """
    settings = for_positions(settings) if coming.positions else settings
    core, hypotheses = _core.LearnerSettings(), _core.HypothesisSettings()
    from_commands = input_name == "command"
    stream = settings.rules().stream_settings(
        settings.segment_length(input_name), from_commands=from_commands
    )
    stream.whole_frames, stream.horizons = True, list(horizons)
    stream.heading_only = coming.gyro_alone
    if coming.sources:
        stream.sources = core_sources(coming.sources, settings.pose_sources, settings.prior.clock_offset_std)
    hypotheses.bases = [settings.body_force.added_to(basis) for basis in settings.bases()]
    hypotheses.dynamics = from_commands
    hypotheses.wheelbase = wheelbase or 0.0 if from_commands else 0.0
    hypotheses.clock_offset, hypotheses.sensor_extrinsics = (
        settings.learn_clock_offset,
        settings.sensor_extrinsics.learn,
    )
    tried, simpler = settings.auto.structures, settings.basis == "auto"
    hypotheses.cascaded, hypotheses.direct = "cascaded" in tried, simpler and "direct" in tried
    hypotheses.baseline = simpler and "baseline" in tried
    hypotheses.filter, average = settings.filter_settings(), _core.ModelAverageSettings()
    if coming.positions:
        _change_prior(hypotheses, straight_side_slip_std=STRAIGHT_SIDE_SLIP)
    if remember and settings.body_force.learned:
        raise SettingsError(
            "a body force and remembered surfaces are not learned together",
            advice="leave out --memory or body_force.frame",
        )
    if remember:
        surfaces = _core.SurfaceSettings()
        surfaces.remember = True
        average.surfaces = surfaces
    hypotheses.average = average
    if car is not None and from_commands:
        if coming.gyro_alone:
            raise SettingsError(
                "throttle and steering cannot be learned from yaw rates alone, which do not show the speed",
                advice="record poses or positions too, or measured speeds: --input wheel",
            )
        stream.car = car
        _behind_curves(hypotheses, settings)
    core.stream, core.hypotheses = stream, hypotheses
    core.learn_disturbance = settings.slip_disturbance.learn
    return core


def _behind_curves(hypotheses: _core.HypothesisSettings, settings: Settings) -> None:
    """Expect little slip and lag where a car's curves hold most of both; named bases stay."""
    if settings.basis == "auto" and set(AUTO_BASES) <= set(settings.auto.bases):
        hypotheses.bases = [basis for basis in hypotheses.bases if basis.name in _CAR_BASES]
    _change_prior(hypotheses, time_constant=_CAR_LAG, delay=_CAR_DELAY)


def _change_prior(hypotheses: _core.HypothesisSettings, **numbers: float) -> None:
    """Set numbers of the prior: what the core hands out of its settings is a copy."""
    causal = hypotheses.filter
    prior = causal.prior
    for name, number in numbers.items():
        setattr(prior, name, number)
    causal.prior = prior
    hypotheses.filter = causal


def car_of(settings: Settings) -> _core.CarPrior | None:
    """Return what is taken of a car commanded by throttle and steering, where the settings name one."""
    car = _reading(settings).car
    return None if car is None else _core.CarPrior(car.top_speed, car.curvature, None)


def wheelbase_of(settings: Settings) -> float | None:
    """Return the wheelbase [m] of a robot that is commanded to steer, where the settings name one."""
    options = _reading(settings)
    return None if options.car is not None else settings.live.wheelbase or options.wheelbase


def _reading(settings: Settings) -> LogOptions:
    named = settings.live.vehicle
    return settings.log_options() if named is None else settings.log_options(vehicle=named)

# SPDX-License-Identifier: Apache-2.0
"""Models for tests, made by hand: any basis, lag and delay, with a covariance and noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from slipwise import _core
from slipwise.models import Model, ModelFile
from slipwise.models.car import car_rows
from slipwise.models.limits import LimitsSection, limit_rows
from slipwise.models.parameter_table import ParameterTable, stage_of

SPEED = (-0.5, 1.5)
YAW_RATE = (-1.2, 1.0)
BODY: Mapping[str, object] = {
    "speed": [-0.45, 1.35],
    "yaw_rate": [-0.7, 0.6],
    "acceleration": [0.5, 0.6],
    "yaw_acceleration": [0.2, 0.4],
    "held": [5.0, 4.0],
    "seconds": 100.0,
}


@dataclass(frozen=True)
class Made:
    """What a model is made of; parameters that are not named are zero, or 0.3 s of lag and 0.2 s of delay."""

    basis: _core.Basis
    values: Mapping[str, float] = field(default_factory=dict)
    std: float = 0.01  # of every parameter
    commands: bool = False
    response: bool = False  # gain and slow mode of the drive; a gain of 0.9, 0.3 of it within 1.5 s
    delays: tuple[float, float] | None = None  # s, from commands without an actuator model
    clock_offset: float | None = None
    limits: Mapping[str, Mapping[str, float]] | None = None  # of the drive: kinds and values by axis
    car: _core.CarCurves | None = None  # commands are throttle and steering
    wheelbase: float | None = None  # m, of a robot that steers
    sensor_extrinsics: tuple[float, float, float] | None = None  # of the pose sensor: x, y [m], yaw [rad]
    fraction: float = 0.05
    psd_motion: float = 1e-3
    psd_time: float = 0.0
    disturbance: tuple[float, float, float] | None = (
        None  # linear, angular [-] and time constant [s] of disturbed slip
    )
    inflation: Mapping[float, float] = field(default_factory=dict)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    speed: tuple[float, float] = SPEED
    yaw_rate: tuple[float, float] = YAW_RATE
    body: Mapping[str, object] | None = field(default_factory=lambda: BODY)  # what the poses show
    good: bool = True
    sentence: str = (
        "The learned model misses by 0.1 m after 5 s, where the kinematic baseline misses by 0.4 m."
    )
    log: str = "drives/monday.mcap"
    identifiable: bool = True


def named(name: str, **values: float) -> Made:
    """Return a shipped basis with values; dots in names are written as two underscores."""
    return Made(_core.named_basis(name), {key.replace("__", "."): value for key, value in values.items()})


LIMITS: Mapping[str, Mapping[str, float]] = {
    "speed": {"dead_band": 0.1, "saturation": 1.1, "slew_rate_up": 0.8, "slew_rate_down": 1.7},
    "yaw_rate": {"dead_band": 0.06, "saturation": 0.7, "slew_rate_up": 1.3, "slew_rate_down": 0.9},
    "side": {"dead_band": 0.05, "saturation": 1.2, "slew_rate_up": 0.9, "slew_rate_down": 1.1},
}


def _limits(axes: Mapping[str, Mapping[str, float]]) -> dict[str, object]:
    learned = {
        axis: {kind: {"value": value, "std": 0.01} for kind, value in axes.get(axis, {}).items()}
        for axis in ("speed", "yaw_rate", "side")
    }
    return {
        **learned,
        "wheel_separation": 0.6,
        "wheel_separation_std": 0.01,
        "gain_v": 1.1,
        "gain_omega": 0.9,
    }


def _slip_disturbance(linear: float, angular: float, time_constant: float) -> dict[str, object]:
    """The named guess, a slower one, and that there is none."""
    guesses = (
        (0.0, 0.0, 1.0, 0.2),
        (linear, angular, time_constant, 0.5),
        (0.0, angular, 4.0 * time_constant, 0.3),
    )
    names = ("linear", "angular", "time_constant", "weight")
    return {"segment": 1.0, "candidates": [dict(zip(names, guess, strict=True)) for guess in guesses]}


def make_model(made: Made) -> Model:
    """Return the model."""
    offset = made.clock_offset is not None
    if made.response:
        motion = _core.MotionModel.with_response(made.basis, offset)
    elif made.delays is not None:
        motion = _core.MotionModel.with_delays(made.basis)
    else:
        motion = _core.MotionModel(made.basis, made.commands, offset)
    motion = motion.with_extrinsics(made.sensor_extrinsics is not None).with_wheelbase(made.wheelbase or 0.0)
    sensor = made.sensor_extrinsics or (0.0, 0.0, 0.0)
    values = dict(zip(("sensor_x", "sensor_y", "sensor_yaw"), sensor, strict=True))
    values |= {"clock_offset": made.clock_offset or 0.0}
    values |= dict(zip(("delay_v", "delay_omega"), made.delays or (0.0, 0.0), strict=True))
    for place in ("v", "omega"):
        values |= {f"log_time_constant_{place}": float(np.log(0.3)), f"log_delay_{place}": float(np.log(0.2))}
        values |= {
            f"gain_{place}": 0.9,
            f"slow_fraction_{place}": 0.3,
            f"log_slow_time_constant_{place}": float(np.log(1.5)),
        }
    values |= dict(made.values)
    names = [info.name for info in motion.parameters]
    assert set(made.values) <= set(names), names
    parameters = [
        {
            "name": info.name,
            "stage": stage_of(info.name),
            "unit": info.unit,
            "value": values.get(info.name, 0.0),
            "std": made.std,
            "prior_std": 0.3,
            "identifiable": made.identifiable,
        }
        for info in motion.parameters
    ]
    content = {
        "slipwise_model": 5,
        "input": "wheel" if not (made.commands or made.response or made.delays) else "command",
        "slip": {
            "basis": made.basis.name,
            "lon": made.basis.lon,
            "lat": made.basis.lat,
            "ang": made.basis.ang,
        },
        "dynamics": made.commands or made.response,
        "response": made.response,
        "delays": made.delays is not None,
        "clock_offset": made.clock_offset is not None,
        "sensor_extrinsics": made.sensor_extrinsics is not None,
        "wheelbase": made.wheelbase,
        "parameters": parameters,
        "covariance": (made.std**2 * np.eye(len(names))).tolist(),
        "noise": {
            "psd_time": [made.psd_time] * 3,
            "psd_motion": [made.psd_motion] * 3,
            "fraction": [made.fraction] * 3,
            "pose_std_xy": 0.02,
            "pose_std_yaw": 0.01,
            "variance_scale": list(made.scale),
            "student_t": {
                seconds: {"inflation": inflation, "dof": 8.0} for seconds, inflation in made.inflation.items()
            },
        },
        "slip_disturbance": None if made.disturbance is None else _slip_disturbance(*made.disturbance),
        "range": {
            "speed": list(made.speed),
            "yaw_rate": list(made.yaw_rate),
            "slope": 0.0,
            "body": made.body,
        },
        "provenance": {
            "slipwise_version": "0.2.0",
            "logs": [{"path": made.log, "sha256": "ab" * 32}],
            "settings": {},
            "learned_seconds": 600.0,
            "learned_segments": 600,
        },
        "verdict": {"good": made.good, "sentence": made.sentence},
    }
    file = ModelFile.model_validate(content)
    table = ParameterTable(tuple(file.parameters), np.array(file.covariance).reshape((len(names),) * 2))
    gains = None
    if made.limits is not None:
        rows, gains = limit_rows(LimitsSection.model_validate(_limits(made.limits))), [1.1, 0.9]
        table = table.beside(rows, np.diag([row.std**2 for row in rows]))
    if made.car is not None:
        table = table.beside(*car_rows(made.car))
    return Model(file.model_copy(update=table.content() | {"limit_gains": gains}))

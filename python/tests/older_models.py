# SPDX-License-Identifier: Apache-2.0
"""Model files as slipwise 0.1 wrote them."""

from __future__ import annotations

from pathlib import Path

import yaml
from sample_models import LIMITS, Made, named

from slipwise import _core
from slipwise.models import Model

# As version 0.1 wrote them, where another name stands today.
OLD = {
    "slip_disturbance": "coloured",
    "sensor_extrinsics": "mount",
    "variance_scale": "scale",
    "student_t": "tails",
    "inflation": "growth",
    "linear": "drift",
    "angular": "turn",
    "segment": "window",
    "wheel_separation": "track",
    "wheel_separation_std": "track_std",
    "saturation": "top",
    "slew_rate_up": "acceleration",
    "slew_rate_down": "braking",
    "identifiable": "determined",
    "learned_segments": "learned_windows",
    "not_identifiable": "undetermined",
    "confounded": "look_alikes",
    "baseline_position": "plain_position",
    "baseline_heading": "plain_heading",
    "segments": "windows",
}
_OF_A_ROW = {"name", "unit", "value", "std", "prior_std", "identifiable"}
PARAMETERS = (("time_constant", "lag"), ("slow_fraction", "slow_share"))
MODELS = {
    "commands with limits": Made(
        _core.named_basis("ipem-9"), commands=True, limits=LIMITS, disturbance=(0.3, 0.5, 4.0)
    ),
    "two modes, behind a sensor": Made(
        _core.named_basis("edd-2"), response=True, sensor_extrinsics=(0.4, 0.1, 0.2), inflation={1.0: 1.5}
    ),
    "wheels": named("edd-2", lon__V=-0.1),
}


def as_it_was(value: object) -> object:
    if isinstance(value, dict):
        return {OLD.get(key, key): as_it_was(each) for key, each in value.items()}
    if isinstance(value, list):
        return [as_it_was(each) for each in value]
    if isinstance(value, str):
        for now, then in PARAMETERS:
            value = value.replace(now, then) if value.endswith(("_v", "_omega")) else value
    return value


def as_sections(model: Model) -> dict[str, object]:
    """The content as schema 4 had it: limits and the curves of a car stand beside the parameters."""
    content: dict[str, object] = yaml.safe_load(model.to_yaml())
    vector = model.vector.content()
    content["parameters"] = [row.model_dump(include=_OF_A_ROW) for row in vector["parameters"]]
    content["covariance"] = vector["covariance"]
    content.pop("limit_gains", None)
    limits, car = model.limits_section, model.car
    content["limits"] = None if limits is None else limits.model_dump()
    if car is not None:
        curves = {
            name: {"at": list(curve.at), "value": list(curve.value), "std": list(curve.std)}
            for name, curve in (("speed", car.speed), ("curvature", car.curvature))
        }
        single = ("lag", "steering_lag", "cornering_drag", "understeer")
        content["car"] = curves | {name: getattr(car, name) for name in single}
    return content


def older(model: Model, version: int, path: Path) -> Path:
    content = as_sections(model) if version == 4 else as_it_was(as_sections(model))
    assert isinstance(content, dict)
    path.write_text(yaml.safe_dump(content | {"slipwise_model": version}), encoding="utf-8")
    return path

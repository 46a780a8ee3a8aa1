# SPDX-License-Identifier: Apache-2.0
"""Model files of older schemas as the present one has them: keys and parameters under their names now."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from slipwise.models.body_force import force_names
from slipwise.models.car import CarSection, car_rows, older_car
from slipwise.models.limits import LimitsSection, limit_rows
from slipwise.models.parameter_table import stage_of
from slipwise.models.schema import SCHEMA_VERSION, Parameter

Floats = NDArray[np.float64]

# 2 lacks the slip disturbance; 3 may have where predictions start; 4 has limits and a car as sections.
READ_VERSIONS = (2, 3, 4, SCHEMA_VERSION)

#: Keys of settings that have another name since version 0.2, in a settings file and in a model's provenance.
RENAMED_SETTINGS: RenamedKeys = {
    "": {"mount": "sensor_extrinsics", "window": "segment"},
    "prior": {"lag": "time_constant"},
    "vehicle": {"track": "wheel_separation"},
    "log": {"track": "wheel_separation"},
    "live": {"terrain": "surface", "terrain_topic": "surface_topic"},
}

_GONE = ("start",)  # sections that nothing reads any more
_RENAMED: RenamedKeys = {
    "": {"coloured": "slip_disturbance", "mount": "sensor_extrinsics"},
    "coloured": {"window": "segment"},
    "coloured.candidates.*": {"drift": "linear", "turn": "angular"},
    "noise": {"scale": "variance_scale", "tails": "student_t"},
    "noise.tails.*": {"growth": "inflation"},
    "limits": {"track": "wheel_separation", "track_std": "wheel_separation_std"},
    "limits.*": {"top": "saturation", "acceleration": "slew_rate_up", "braking": "slew_rate_down"},
    "parameters.*": {"determined": "identifiable"},
    "provenance": {"learned_windows": "learned_segments"},
    "verdict": {"undetermined": "not_identifiable", "look_alikes": "confounded"},
    "verdict.held_out": {
        "windows": "segments",
        "plain_position": "baseline_position",
        "plain_heading": "baseline_heading",
    },
    **{f"provenance.settings.{place}".rstrip("."): names for place, names in RENAMED_SETTINGS.items()},
}
_PARAMETER = re.compile(r"^(log_)?(slow_)?(lag|share)_(v|omega)$")


#: Names since, by the older ones, by where these stand; a `*` stands for any key or place in a list.
RenamedKeys = Mapping[str, Mapping[str, str]]


def upgraded(content: Mapping[str, object]) -> dict[str, object]:
    """Return the content of a model file of an older schema, as the present one names it.

    What is not known here stays as it is, so that the schema refuses it by its name.
    """
    kept = {
        key: value for key, value in content.items() if key not in _GONE or content["slipwise_model"] == 4
    }
    result: dict[str, object] = kept
    if content.get("slipwise_model") != 4:
        result = {key: _named(value) for key, value in _renamed(kept).items()}
    return _in_one_table(result) | {"slipwise_model": SCHEMA_VERSION}


def with_delay(content: dict[str, object]) -> dict[str, object]:
    """Return the content with a delay of zero for a car that was learned without one."""
    rows, covariance = content.get("parameters"), content.get("covariance")
    if not isinstance(rows, list) or not isinstance(covariance, list):
        return content
    names = [row.get("name") if isinstance(row, dict) else None for row in rows]
    if "car.understeer" not in names or "car.delay" in names:
        return content
    at = names.index("car.understeer") + 1
    row = Parameter(
        name="car.delay", stage="car", unit="s", value=0.0, std=0.0, prior_std=0.0, identifiable=True
    )
    wider = [[*each[:at], 0.0, *each[at:]] if isinstance(each, list) else each for each in covariance]
    beside = [0.0] * (len(covariance) + 1)
    return content | {
        "parameters": [*rows[:at], row.model_dump(), *rows[at:]],
        "covariance": [*wider[:at], beside, *wider[at:]],
    }


def _in_one_table(content: dict[str, object]) -> dict[str, object]:
    """The same with limits and the curves of a car as rows of its parameters.

    Raises:
        ValidationError: such a section is wrong.
    """
    rows, covariance = content.get("parameters"), content.get("covariance")
    limits, car = content.pop("limits", None), content.pop("car", None)
    if not isinstance(rows, list) or not isinstance(covariance, list):
        return content
    force = content.get("body_force")
    frame = force.get("frame") if isinstance(force, dict) else None
    names = force_names(frame) if frame in ("body", "world") else ()
    content["parameters"] = [
        {**row, "stage": stage_of(str(row.get("name")), names)} if isinstance(row, dict) else row
        for row in rows
    ]
    if limits is not None:
        section = LimitsSection.model_validate(limits)
        content["limit_gains"] = [section.gain_v, section.gain_omega]
        found = limit_rows(section)
        _add(content, found, np.diag([row.std**2 for row in found]))
    if car is not None:
        _add(content, *car_rows(older_car(CarSection.model_validate(car))))
    return content


def _add(content: dict[str, object], rows: list[Parameter], covariance: Floats) -> None:
    """Add rows that were learned apart; the schema refuses a covariance of another shape."""
    before, old = content["parameters"], content["covariance"]
    assert isinstance(before, list)
    assert isinstance(old, list)
    beside = [0.0] * len(rows)
    content["parameters"] = [*before, *(row.model_dump() for row in rows)]
    content["covariance"] = [
        *([*row, *beside] if isinstance(row, list) else row for row in old),
        *([0.0] * len(old) + row for row in covariance.tolist()),
    ]


def _renamed(content: dict[str, object]) -> dict[str, object]:
    result = with_new_keys(content, _RENAMED)
    return result if isinstance(result, dict) else content


def _named(value: object) -> object:
    """The same, with parameters under the names they have now, wherever one is named."""
    if isinstance(value, dict):
        return {key: _named(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_named(each) for each in value]
    return _PARAMETER.sub(_parameter, value) if isinstance(value, str) else value


def _parameter(found: re.Match[str]) -> str:
    kind = {"lag": "time_constant", "share": "fraction"}[found[3]]
    return f"{found[1] or ''}{found[2] or ''}{kind}_{found[4]}"


def with_new_keys(content: object, renamed: RenamedKeys, place: tuple[str, ...] = ()) -> object:
    """Return `content` with every older key replaced; all else stays as it is.

    Args:
        content: dictionaries, lists and values, such as a YAML or TOML file gives.
        renamed: the new names of keys, by the old place of their dictionary: its keys joined by dots.
        place: the keys that lead to `content` in the document.
    """
    if isinstance(content, dict):
        names = _names_at(place, renamed)
        return {
            names.get(str(key), key): with_new_keys(value, renamed, (*place, str(key)))
            for key, value in content.items()
        }
    if isinstance(content, list):
        return [with_new_keys(value, renamed, (*place, "*")) for value in content]
    return content


def _names_at(place: tuple[str, ...], renamed: RenamedKeys) -> dict[str, str]:
    """The names for the dictionary at a place: those of every pattern that is of it."""
    found: dict[str, str] = {}
    for pattern, names in renamed.items():
        wanted = pattern.split(".") if pattern else []
        if len(wanted) == len(place) and all(b in ("*", a) for a, b in zip(place, wanted, strict=True)):
            found |= names
    return found

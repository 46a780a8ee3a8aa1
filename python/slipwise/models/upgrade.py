# SPDX-License-Identifier: Apache-2.0
"""Model files of older schemas as the present one has them: keys and parameters under their names now."""

from __future__ import annotations

import re
from collections.abc import Mapping

from slipwise.models.renamed_keys import RenamedKeys, with_new_keys
from slipwise.models.schema import SCHEMA_VERSION

READ_VERSIONS = (2, 3, SCHEMA_VERSION)  # 2 lacks the slip disturbance; 3 may have where predictions start

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


def upgraded(content: Mapping[str, object]) -> dict[str, object]:
    """Return the content of a model file of an older schema, as the present one names it.

    What is not known here stays as it is, so that the schema refuses it by its name.
    """
    kept = {key: value for key, value in content.items() if key not in _GONE}
    result: dict[str, object] = {key: _named(value) for key, value in _renamed(kept).items()}
    return result | {"slipwise_model": SCHEMA_VERSION}


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

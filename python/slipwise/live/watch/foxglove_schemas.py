# SPDX-License-Identifier: Apache-2.0
"""What Foxglove has no schema of its own for, as JSON with one: state, parameters, slip now, NIS."""

from __future__ import annotations

import math
from typing import Any

from slipwise.live.outputs import Status

_NUMBER = {"type": ["number", "null"]}  # null where there is none
_TEXT = {"type": "string"}
_EXPECTED_NIS = 3.0


def _object(title: str, properties: dict[str, Any]) -> dict[str, Any]:
    return {"title": title, "type": "object", "properties": properties}


_KNOWN = _object(
    "slipwise.Known",
    {**dict.fromkeys(("known", "prior_std", "std", "target_std"), _NUMBER), "unit": _TEXT},
)

#: By the topic below the node's.
SCHEMAS: dict[str, dict[str, Any]] = {
    "state": _object(
        "slipwise.State",
        {
            "vehicle": _TEXT,
            "state": _TEXT,
            "why": _TEXT,
            "validity": _TEXT,
            "validity_why": _TEXT,
            "input": _TEXT,
            "apply": _TEXT,
            "segments": {"type": "integer"},
            "since_pose": _NUMBER,
            "held_out_position": _NUMBER,
            "held_out_heading": _NUMBER,
            "baseline_position": _NUMBER,
            "baseline_heading": _NUMBER,
            "left_out": {"type": "object", "additionalProperties": {"type": "integer"}},
        },
    ),
    "parameters": _object(
        "slipwise.Parameters",
        {
            "parameters": {
                "type": "array",
                "items": _object(
                    "slipwise.Parameter",
                    {
                        "name": _TEXT,
                        "unit": _TEXT,
                        "value": _NUMBER,
                        "std": _NUMBER,
                        "low": _NUMBER,
                        "high": _NUMBER,
                        "prior_std": _NUMBER,
                        "start": _NUMBER,
                        "applied": _NUMBER,
                        "validity": _TEXT,
                    },
                ),
            }
        },
    ),
    "slip": _object("slipwise.Slip", {"forward": _NUMBER, "sideways": _NUMBER, "yaw_rate": _NUMBER}),
    "next_moves": _object(
        "slipwise.NextMoves",
        {
            "moves": {
                "type": "array",
                "items": _object(
                    "slipwise.Move",
                    {
                        **dict.fromkeys(("v", "omega", "seconds", "yaw_std", "position_std"), _NUMBER),
                        "teaches": _TEXT,
                    },
                ),
            },
            "predictions": {"type": "object", "additionalProperties": _KNOWN},
            "parameters": {"type": "object", "additionalProperties": _KNOWN},
            "why": _TEXT,
        },
    ),
    "nis": _object("slipwise.Nis", {"nis": _NUMBER, "expected": _NUMBER, "segments": {"type": "integer"}}),
}


def state_of(status: Status) -> dict[str, Any]:
    """Return state, validity, errors and counts."""
    held_out = status.held_out or (math.nan,) * 4
    names = ("held_out_position", "held_out_heading", "baseline_position", "baseline_heading")
    return {
        "vehicle": _text(status.vehicle),
        "state": status.state,
        "why": _text(status.why),
        "validity": status.validity,
        "validity_why": _text(status.validity_why),
        "input": status.input,
        "apply": status.apply,
        "segments": status.segments,
        "since_pose": None if status.odometry is None else _number(status.odometry.since_pose),
        **{name: _number(value) for name, value in zip(names, held_out, strict=True)},
        "left_out": {_text(reason): count for reason, count in status.counts.items()},
    }


def parameters_of(status: Status) -> dict[str, Any]:
    """Return the parameters; `low` and `high` are a standard deviation away from the value."""
    return {
        "parameters": [
            {
                "name": _text(p.name),
                "unit": _text(p.unit),
                "value": _number(p.value),
                "std": _number(p.std),
                "low": _number(p.value - p.std),
                "high": _number(p.value + p.std),
                "prior_std": _number(p.prior_std),
                "start": _number(p.start),
                "applied": None if p.applied is None else _number(p.applied),
                "validity": p.validity,
            }
            for p in status.parameters
        ]
    }


def slip_of(status: Status) -> dict[str, Any] | None:
    """Return slip now [m/s, m/s, rad/s]; None where nothing is predicted."""
    if status.slip is None:
        return None
    forward, sideways, yaw_rate = (_number(value) for value in status.slip.tolist())
    return {"forward": forward, "sideways": sideways, "yaw_rate": yaw_rate}


def nis_of(status: Status) -> dict[str, Any] | None:
    """Return the NIS of the newest segment; None before there is one."""
    if status.nis is None:
        return None
    return {"nis": _number(status.nis), "expected": _EXPECTED_NIS, "segments": status.segments}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _text(text: str) -> str:
    return text.encode("utf-8", "replace").decode("utf-8")

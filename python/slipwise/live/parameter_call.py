# SPDX-License-Identifier: Apache-2.0
"""ROS 2's SetParameters: the request for learned values, and what a node refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

SET_PARAMETERS = "rcl_interfaces/srv/SetParameters"
REQUEST, RESPONSE = f"{SET_PARAMETERS}_Request", f"{SET_PARAMETERS}_Response"
_BOOL, _DOUBLE, _STRING, _DOUBLES = 1, 3, 4, 8  # of rcl_interfaces/msg/ParameterType


@dataclass(frozen=True)
class ParameterRequest:
    """What a node is asked to take."""

    payload: bytes  # CDR with its header
    names: list[str]  # of the parameters in it
    left_out: list[str]  # sentences about those that have no type that ROS knows


def request_of(values: Mapping[str, Any], store: Typestore) -> ParameterRequest:
    """Return the request for values by their names."""
    types: dict[str, Any] = dict(store.types)
    parameters, names, left_out = [], [], []
    for name, value in values.items():
        made = _value(types, value)
        if made is None:
            left_out.append(f"{name} has no type that SetParameters knows")
        else:
            parameters.append(types["rcl_interfaces/msg/Parameter"](name, made))
            names.append(name)
    return ParameterRequest(bytes(store.serialize_cdr(types[REQUEST](parameters), REQUEST)), names, left_out)


def refused(answer: bytes, names: Sequence[str], store: Typestore) -> list[str]:
    """Return what the node did not take, and why."""
    message: Any = store.deserialize_cdr(answer, RESPONSE)
    return [
        f"{name} was refused: {result.reason or 'without a reason'}"
        for name, result in zip(names, message.results, strict=False)
        if not result.successful
    ]


def _value(types: Mapping[str, Any], value: Any) -> Any:
    kind = _DOUBLE
    made: dict[str, Any] = {"bool_value": False, "double_value": 0.0, "string_value": ""}
    doubles: list[float] = []
    if isinstance(value, bool):
        kind, made["bool_value"] = _BOOL, value
    elif isinstance(value, float):
        made["double_value"] = value
    elif isinstance(value, str):
        kind, made["string_value"] = _STRING, value
    elif isinstance(value, list) and all(isinstance(item, float) for item in value):
        kind, doubles = _DOUBLES, value
    else:
        return None
    return types["rcl_interfaces/msg/ParameterValue"](
        type=kind,
        integer_value=0,
        byte_array_value=np.zeros(0, np.uint8),
        bool_array_value=np.zeros(0, np.bool_),
        integer_array_value=np.zeros(0, np.int64),
        double_array_value=np.array(doubles, np.float64),
        string_array_value=[],
        **made,
    )

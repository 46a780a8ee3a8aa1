# SPDX-License-Identifier: Apache-2.0
"""ROS 2's parameter services: what a node says of its parameters, and the request to set all or none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from slipwise.live.outputs import AppliedParameters
from slipwise.live.wires.wire import RosWire

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

DESCRIBE = "rcl_interfaces/srv/DescribeParameters"
SET = "rcl_interfaces/srv/SetParametersAtomically"
_BOOL, _DOUBLE, _STRING, _BOOLS, _DOUBLES = 1, 3, 4, 6, 8  # of rcl_interfaces/msg/ParameterType
_UNKNOWN = 0
_KINDS = ("no", "bool", "integer", "double", "string", "bytes", "bools", "integers", "doubles", "strings")
ANSWER_WITHIN = 2.0  # s


@dataclass(frozen=True)
class Refusals:
    """Why a node cannot take values while it runs: by parameters."""

    read_only: list[str]
    others: list[str]  # sentences

    def __bool__(self) -> bool:
        return bool(self.read_only or self.others)


def describe_request(names: Sequence[str], store: Typestore) -> bytes:
    """Return the request for the descriptors of parameters, CDR with its header."""
    request = dict(store.types)[f"{DESCRIBE}_Request"](list(names))
    return bytes(store.serialize_cdr(request, f"{DESCRIBE}_Request"))


def refusals(answer: bytes, values: Mapping[str, Any], store: Typestore) -> Refusals:
    """Return which of the values a node would not take, by its descriptors."""
    message: Any = store.deserialize_cdr(answer, f"{DESCRIBE}_Response")
    descriptors = list(message.descriptors)
    if len(descriptors) != len(values):  # rclcpp describes none where it does not know one
        return Refusals([], [f"it does not have all of {', '.join(values)}"])
    found = Refusals([], [])
    for (name, value), descriptor in zip(values.items(), descriptors, strict=True):
        if descriptor.read_only:
            found.read_only.append(name)
        elif descriptor.type == _UNKNOWN and not descriptor.dynamic_typing:
            found.others.append(f"it has no {name}")
        elif descriptor.type not in (kind_of(value), _UNKNOWN) and not descriptor.dynamic_typing:
            found.others.append(f"its {name} is {_kind_text(descriptor.type)}")
    return found


def set_request(values: Mapping[str, Any], store: Typestore) -> bytes:
    """Return the request to set all values or none, CDR with its header."""
    types: dict[str, Any] = dict(store.types)
    parameters = [
        types["rcl_interfaces/msg/Parameter"](name, _value(types, value)) for name, value in values.items()
    ]
    return bytes(store.serialize_cdr(types[f"{SET}_Request"](parameters), f"{SET}_Request"))


def why_refused(answer: bytes, store: Typestore) -> str:
    """Return why the node took none of the values; empty where it took all."""
    message: Any = store.deserialize_cdr(answer, f"{SET}_Response")
    return "" if message.result.successful else (message.result.reason or "it gives no reason")


def kind_of(value: Any) -> int:
    """Return the number of a value's type in `rcl_interfaces/msg/ParameterType`; 0 for what has none."""
    if isinstance(value, bool):
        return _BOOL
    if isinstance(value, float):
        return _DOUBLE
    if isinstance(value, str):
        return _STRING
    if isinstance(value, list) and value and all(isinstance(item, bool) for item in value):
        return _BOOLS
    if isinstance(value, list) and all(isinstance(item, float) for item in value):
        return _DOUBLES
    return _UNKNOWN


def _kind_text(kind: int) -> str:
    return f"of type {_KINDS[kind]}" if kind < len(_KINDS) else f"of type {kind}"


def _value(types: Mapping[str, Any], value: Any) -> Any:
    kind = kind_of(value)
    if kind == _UNKNOWN:
        raise TypeError(f"a parameter cannot be {value!r}")
    return types["rcl_interfaces/msg/ParameterValue"](
        type=kind,
        bool_value=value if kind == _BOOL else False,
        integer_value=0,
        double_value=value if kind == _DOUBLE else 0.0,
        string_value=value if kind == _STRING else "",
        byte_array_value=np.zeros(0, np.uint8),
        bool_array_value=np.array(value if kind == _BOOLS else [], np.bool_),
        integer_array_value=np.zeros(0, np.int64),
        double_array_value=np.array(value if kind == _DOUBLES else [], np.float64),
        string_array_value=[],
    )


class NodeParameters:
    """Asks nodes, and says what became of it: each thing once, until something else happens to that node.

    Args:
        wire: carries the calls.
        store: of the message types.
    """

    def __init__(self, wire: RosWire, store: Typestore) -> None:
        self._wire, self._store = wire, store
        self._said: dict[str, str] = {}

    def set(self, applied: AppliedParameters) -> str:
        """Set all values of a node, or none; return what is to be said, empty where that was said before."""
        text = f"{applied.target}: {self._outcome(applied)}"
        known, self._said[applied.node] = self._said.get(applied.node), text
        return "" if known == text else text

    def _outcome(self, applied: AppliedParameters) -> str:
        node, values, store = applied.node, applied.values, self._store
        names = ", ".join(values)
        described = self._call(node, "describe_parameters", DESCRIBE, describe_request(list(values), store))
        if described is None:
            return f"{node} does not answer: its parameters are as they were"
        found = refusals(described, values, store)
        if found.others:
            return f"nothing of {node} was set: {'; '.join(found.others)}"
        if found.read_only:
            return (
                f"nothing of {node} was set: {', '.join(found.read_only)} cannot be changed while it runs."
                f" Restart it with {applied.file or 'the exported file'}"
            )
        answer = self._call(node, "set_parameters_atomically", SET, set_request(values, store))
        if answer is None:
            return f"{node} does not answer: whether it took {names} is not known"
        why = why_refused(answer, store)
        return f"{node} refused {names}, nothing was set: {why}" if why else f"{node} took {names}"

    def _call(self, node: str, service: str, kind: str, request: bytes) -> bytes | None:
        return self._wire.call(f"{node}/{service}", kind, request, timeout=ANSWER_WITHIN)

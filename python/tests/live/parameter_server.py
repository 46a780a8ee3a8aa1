# SPDX-License-Identifier: Apache-2.0
"""A wire behind which one node serves its parameters, as rclcpp does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from slipwise.live.parameter_call import DESCRIBE, SET
from slipwise.live.wires.ros_types import ros_types

PARAMETERS = ("left", "right")


def descriptor(kind: int, *, read_only: bool = False) -> Any:
    """Return a descriptor of a parameter of a type, by `rcl_interfaces/msg/ParameterType`."""
    return dict(ros_types().types)["rcl_interfaces/msg/ParameterDescriptor"](
        name="",
        type=kind,
        description="",
        additional_constraints="",
        read_only=read_only,
        dynamic_typing=False,
        floating_point_range=[],
        integer_range=[],
    )


class ParameterServer:
    """Answers the calls of a wire.

    Args:
        table: descriptors by name; None: the node is not there.
        reason: for which it refuses all that is set.
    """

    def __init__(self, table: Mapping[str, Any] | None, reason: str = "") -> None:
        self._table, self._reason = table, reason
        self.values: dict[str, Any] = {}
        self.sets = 0

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        """Answer as the service does."""
        if self._table is None:
            return None
        store, types = ros_types(), dict(ros_types().types)
        message: Any = store.deserialize_cdr(request, f"{type_name}_Request")
        if type_name == DESCRIBE:
            known = all(name in self._table for name in message.names)
            found = [self._table[name] for name in message.names] if known else []
            answer = types[f"{DESCRIBE}_Response"](found)
            return bytes(store.serialize_cdr(answer, f"{DESCRIBE}_Response"))
        assert (service.rpartition("/")[2], type_name) == ("set_parameters_atomically", SET)
        self.sets += 1
        if not self._reason:
            self.values |= {p.name: p.value.double_value for p in message.parameters}
        result = types["rcl_interfaces/msg/SetParametersResult"](not self._reason, self._reason)
        return bytes(store.serialize_cdr(types[f"{SET}_Response"](result), f"{SET}_Response"))

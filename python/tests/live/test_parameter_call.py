# SPDX-License-Identifier: Apache-2.0
"""Learned values become a request of SetParameters, and refusals are said."""

from __future__ import annotations

from typing import Any

import numpy as np

from slipwise.live.parameter_call import REQUEST, RESPONSE, refused, request_of
from slipwise.live.wires.ros_types import ros_types


def test_each_kind_of_value_has_its_type() -> None:
    values: dict[str, Any] = {"a": 0.5, "b": True, "c": "mppi::X", "d": [1.0, 2.0], "e": {"no": "type"}}
    request = request_of(values, ros_types())
    read: Any = ros_types().deserialize_cdr(request.payload, REQUEST)
    found = {p.name: p.value for p in read.parameters}
    assert list(found) == ["a", "b", "c", "d"]
    assert (found["a"].type, found["a"].double_value) == (3, 0.5)
    assert (found["b"].type, bool(found["b"].bool_value)) == (1, True)
    assert (found["c"].type, found["c"].string_value) == (4, "mppi::X")
    assert found["d"].type == 8
    np.testing.assert_array_equal(found["d"].double_array_value, [1.0, 2.0])
    assert request.names == ["a", "b", "c", "d"]
    assert request.left_out == ["e has no type that SetParameters knows"]


def test_what_a_node_refuses_is_said_by_its_name() -> None:
    store = ros_types()
    result = store.types["rcl_interfaces/msg/SetParametersResult"]
    answer = store.types[RESPONSE]([result(True, ""), result(False, "read-only")])
    payload = bytes(store.serialize_cdr(answer, RESPONSE))
    assert refused(payload, ["vx_max", "wz_max"], store) == ["wz_max was refused: read-only"]

# SPDX-License-Identifier: Apache-2.0
"""Learned values become a request that a node takes whole or not at all, and only where it can take all."""

from __future__ import annotations

from typing import Any

import numpy as np
from live.parameter_server import PARAMETERS, ParameterServer, descriptor

from slipwise.live.outputs import AppliedParameters
from slipwise.live.parameter_call import SET, NodeParameters, set_request
from slipwise.live.wires.ros_types import ros_types


def test_each_kind_of_value_has_its_type() -> None:
    values: dict[str, Any] = {"a": 0.5, "b": True, "c": "mppi::X", "d": [1.0, 2.0], "e": [True, False]}
    read: Any = ros_types().deserialize_cdr(set_request(values, ros_types()), f"{SET}_Request")
    found = {p.name: p.value for p in read.parameters}
    assert (found["a"].type, found["a"].double_value) == (3, 0.5)
    assert (found["b"].type, bool(found["b"].bool_value)) == (1, True)
    assert (found["c"].type, found["c"].string_value) == (4, "mppi::X")
    assert found["d"].type == 8
    np.testing.assert_array_equal(found["d"].double_array_value, [1.0, 2.0])
    assert found["e"].type == 6
    np.testing.assert_array_equal(found["e"].bool_array_value, [True, False])


def asked(server: ParameterServer, values: dict[str, Any], times: int = 1) -> list[str]:
    nodes = NodeParameters(server, ros_types())
    told = AppliedParameters(1.0, "diff-drive", "/controller", values, "apply/diff_drive_controller.yaml")
    return [text for _ in range(times) if (text := nodes.set(told))]


def test_a_node_that_takes_all_is_told_all_and_that_is_said_once() -> None:
    server = ParameterServer({name: descriptor(3) for name in PARAMETERS})
    assert asked(server, {"left": 1.1, "right": 1.2}, times=31) == [
        "diff-drive: /controller took left, right"
    ]
    assert server.values == {"left": 1.1, "right": 1.2}


def test_where_one_is_read_only_nothing_is_set_and_the_file_is_named_once() -> None:
    server = ParameterServer({"left": descriptor(3), "right": descriptor(3, read_only=True)})
    (said,) = asked(server, {"left": 1.1, "right": 1.2}, times=31)
    assert "nothing of /controller was set: right cannot be changed while it runs" in said
    assert "apply/diff_drive_controller.yaml" in said
    assert server.values == {}
    assert server.sets == 0


def test_what_a_node_does_not_have_or_has_of_another_type_sets_nothing() -> None:
    for table, why in (
        ({"left": descriptor(3), "right": descriptor(0)}, "it has no right"),
        ({"left": descriptor(3), "right": descriptor(2)}, "its right is of type integer"),
        ({"left": descriptor(3)}, "it does not have all of left, right"),
    ):
        server = ParameterServer(table)
        assert why in asked(server, {"left": 1.1, "right": 1.2})[0]
        assert server.values == {}


def test_a_refusal_is_said_with_its_reason_and_a_silent_node_with_what_is_known() -> None:
    refusing = ParameterServer({name: descriptor(3) for name in PARAMETERS}, reason="speed limit is active")
    (said,) = asked(refusing, {"left": 1.1, "right": 1.2}, times=5)
    assert said.endswith("nothing was set: speed limit is active")
    (said,) = asked(ParameterServer(None), {"left": 1.1}, times=5)
    assert "does not answer: its parameters are as they were" in said

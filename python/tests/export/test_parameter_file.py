# SPDX-License-Identifier: Apache-2.0
"""A parameter file is YAML that gives every value back, with the type that ROS wants."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from slipwise.errors import ModelError
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, Value, yaml_value


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e30, max_value=1e30))
def test_a_float_is_read_back_as_a_float(value: float) -> None:
    again = yaml.safe_load(yaml_value(value))
    assert isinstance(again, float)
    assert again == pytest.approx(value, rel=1e-5)


def test_a_value_is_read_back(subtests: pytest.Subtests) -> None:
    for value in [True, False, "mppi::DiffDriveMotionModel", [True, False], [1.0, -2.5e-8]]:
        with subtests.test(value=value):
            assert yaml.safe_load(yaml_value(value)) == value


@given(st.text())
def test_any_string_is_read_back(text: str) -> None:
    assert yaml.safe_load(yaml_value(text)) == text


@pytest.mark.parametrize("value", [float("nan"), float("inf"), [1.0, float("-inf")]])
def test_what_is_no_number_is_refused(value: Value) -> None:
    with pytest.raises(ModelError, match=r"a parameter would be .*, which is not a number"):
        yaml_value(value)


def test_no_line_of_a_comment_can_end_it() -> None:
    hostile = "a\rb: 1\x85c: 2\u2028d: 3\ne: 4"
    file = ParameterFile("node", [Entry(("x",), 1.0, hostile), Kept(("y",), hostile)], notes=[hostile])
    assert yaml.safe_load(file.text([hostile])) == {"node": {"ros__parameters": {"x": 1.0}}}


def test_nested_keys_are_written_once_and_comments_are_comments() -> None:
    file = ParameterFile(
        "node",
        [
            Entry(("a", "x"), 1.0, "first\nin two lines"),
            Entry(("a", "b", "y"), True, "second"),
            Entry(("a", "z"), 2.0, "third"),
            Entry(("linear.x.max",), 3.0, "a dot in a name"),
        ],
        notes=["a note: with a colon\nand a second line"],
    )
    text = file.text(["origin"])
    parameters = yaml.safe_load(text)["node"]["ros__parameters"]
    assert parameters == {"a": {"x": 1.0, "b": {"y": True}, "z": 2.0}, "linear.x.max": 3.0}
    assert text.startswith("# origin\n#\n# a note: with a colon\n# and a second line\nnode:\n")
    assert text.count("    a:\n") == 1
    assert file.values() == {"a.x": 1.0, "a.b.y": True, "a.z": 2.0, "linear.x.max": 3.0}


def test_a_long_list_is_wrapped_and_read_back() -> None:
    values = [float(i) for i in range(225)]
    text = ParameterFile("node", [Entry(("matrix",), values, "rows")]).text([])
    assert yaml.safe_load(text)["node"]["ros__parameters"]["matrix"] == values
    assert max(map(len, text.splitlines())) < 120

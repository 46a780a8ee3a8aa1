# SPDX-License-Identifier: Apache-2.0
"""YAML from anywhere is plain data of a sane size, or refused with the line named."""

from __future__ import annotations

from pathlib import Path

import pytest

from slipwise.errors import ModelError, SettingsError
from slipwise.models.yaml_file import MAX_BYTES, read_yaml

LAUGHS = "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n"
HOSTILE = {
    "aliases": (LAUGHS, "aliases are not allowed"),
    "python tag": ("a: !!python/object/apply:os.system [echo]\n", "tag .*python/object.* is not allowed"),
    "local tag": ("a: !mine 1\n", "the tag !mine is not allowed"),
    "tag of a mapping": ("!!map {a: 1}\n", "tag .* is not allowed"),
    "binary": ("a: !!binary aGk=\n", "tag .* is not allowed"),
    "long integer": (f"a: {'9' * 10_000}\n", "a number is too long"),
    "long decimal": (f"a: 1.{'9' * 10_000}\n", "a number is too long"),
    "sexagesimal": (f"a: 1{':59' * 5000}\n", "a number is too long"),
    "doubled key": ("a: 1\nb: 2\na: 3\n", "a key stands twice"),
    "doubled key in depth": ("a: {b: 1, b: 2}\n", "a key stands twice"),
    "equal keys of two kinds": ("a: {1: x, 1.0: y}\n", "a key stands twice"),
    "merge": ("a: {<<: {b: 1}}\n", "merges are not allowed"),
    "unhashable key": ("? [a, b]\n: 1\n", "unhashable"),
    "deep nesting": ("a: " + "[" * 20_000 + "\n", "not a plain YAML file"),
    "deep nesting, closed": ("a: " + "[" * 5000 + "]" * 5000 + "\n", "not a plain YAML file"),
    "impossible date": ("a: 2024-99-99\n", "not a plain YAML file"),
    "two documents": ("a: 1\n---\nb: 1\n", "not a plain YAML file"),
    "broken": ("a: [1, 2\nb: 3\n", "not a plain YAML file"),
    "control characters": ("a: \x00\x01\n", "not a plain YAML file"),
    "list": ("- 1\n- 2\n", "the file holds no keys"),
    "scalar": ("3\n", "the file holds no keys"),
    "empty": ("", "the file holds no keys"),
    "comments": ("# nothing\n", "the file holds no keys"),
}


def test_hostile_text_is_refused_with_its_file(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for name, (text, message) in HOSTILE.items():
        with subtests.test(name=name):
            path = tmp_path / "m.yaml"
            path.write_text(text, encoding="utf-8")
            with pytest.raises(ModelError, match=message) as caught:
                read_yaml(path)
            assert caught.value.where.startswith(str(path))
            assert caught.value.advice
            assert len(str(caught.value)) < 1000


def test_line_of_the_fault_is_named(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    path.write_text("a: 1\nb: &x 2\nc: *x\n", encoding="utf-8")
    with pytest.raises(ModelError, match=r"m\.yaml, line 3\)"):
        read_yaml(path)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    path.write_bytes(b"\x80\x81\xfe\xff")
    with pytest.raises(ModelError, match="not a plain YAML file"):
        read_yaml(path)


def test_file_above_the_limit_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    path.write_bytes(b"a: " + b"x" * (MAX_BYTES + 1_000_000))
    with pytest.raises(ModelError, match=f"the file is too large .* at most {MAX_BYTES} bytes are read"):
        read_yaml(path)


def test_missing_file_and_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"cannot read: No such file or directory \(.*none\.yaml\)"):
        read_yaml(tmp_path / "none.yaml")
    with pytest.raises(ModelError, match="cannot read: Is a directory"):
        read_yaml(tmp_path)


def test_plain_data_is_read_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    path.write_text("a: 1.0e-5\nb: [1, true, text]\nc: {d: null, 2.0: .5}\n", encoding="utf-8")
    assert read_yaml(path) == {"a": 1e-5, "b": [1, True, "text"], "c": {"d": None, 2.0: 0.5}}


def test_error_type_is_the_callers(tmp_path: Path) -> None:
    with pytest.raises(SettingsError):
        read_yaml(tmp_path / "none.yaml", error=SettingsError)

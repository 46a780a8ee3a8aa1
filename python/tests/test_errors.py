# SPDX-License-Identifier: Apache-2.0
"""An error says on one line what is wrong, where, and what to do."""

import pytest

from slipwise.errors import LogError, ModelError, OutputError, SettingsError, SlipwiseError


@pytest.mark.parametrize("kind", [LogError, ModelError, OutputError, SettingsError])
def test_every_error_has_the_one_root(kind: type[SlipwiseError]) -> None:
    assert issubclass(kind, SlipwiseError)


def test_text_has_what_where_and_advice() -> None:
    error = LogError("no poses", where="run.csv", advice="record some")
    assert str(error) == "no poses (run.csv): record some"
    assert (error.what, error.where, error.advice) == ("no poses", "run.csv", "record some")


def test_what_alone_is_enough() -> None:
    assert str(SlipwiseError("no poses")) == "no poses"


def test_text_of_several_lines_becomes_one_line() -> None:
    assert str(ModelError("first\nsecond", where="a\nb")) == "first second (a b)"

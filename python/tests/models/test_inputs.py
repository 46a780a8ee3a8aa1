# SPDX-License-Identifier: Apache-2.0
"""Tests of models.inputs: how an input may be named."""

from __future__ import annotations

import pytest

from slipwise.calibration.settings import make_settings
from slipwise.errors import SettingsError
from slipwise.models.inputs import input_name_of


def test_an_input_is_named_in_the_singular_or_the_plural() -> None:
    names = [input_name_of(text) for text in ("command", "commands", "wheel", "wheels")]
    assert names == ["command", "command", "wheel", "wheel"]
    assert make_settings({"live": {"input": "wheels"}}).live.input == "wheel"


def test_another_input_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(SettingsError, match=r"unknown input 'joystick'.*use command or wheel"):
        input_name_of("joystick")

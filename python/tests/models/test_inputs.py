# SPDX-License-Identifier: Apache-2.0
"""Tests of models.inputs: how an input may be named."""

from __future__ import annotations

import pytest
from sample_models import make_model, named

from slipwise.calibration.settings import make_settings
from slipwise.errors import ModelError, SettingsError
from slipwise.models.common_input import of_common_input
from slipwise.models.inputs import input_name_of


def test_an_input_is_named_in_the_singular_or_the_plural() -> None:
    names = [input_name_of(text) for text in ("command", "commands", "wheel", "wheels")]
    assert names == ["command", "command", "wheel", "wheel"]
    assert make_settings({"live": {"input": "wheels"}}).live.input == "wheel"


def test_models_that_lack_the_input_that_is_asked_for_are_refused() -> None:
    model = make_model(named("edd-2"))
    (has,) = model.inputs
    assert of_common_input({"a": model}, has) == {"a": model}
    lacks = "wheel" if has == "command" else "command"
    with pytest.raises(ModelError, match=r"the model was learned from .*, and nothing from"):
        of_common_input({"a": model}, lacks)


def test_another_input_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(SettingsError, match=r"unknown input 'joystick'.*use command or wheel"):
        input_name_of("joystick")

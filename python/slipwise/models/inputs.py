# SPDX-License-Identifier: Apache-2.0
"""What a model can be learned from and answer from: commands, or wheel speeds; by name and in words."""

from __future__ import annotations

from typing import Literal

from slipwise.errors import SettingsError

InputName = Literal["command", "wheel"]
INPUT_NAMES: tuple[InputName, InputName] = ("command", "wheel")
MANY = {"command": "commands", "wheel": "wheel speeds"}

_PLURALS = {"commands": "command", "wheels": "wheel"}


def singular(name: object) -> object:
    """Return the name of an input that is given in the plural; anything else as it is."""
    return _PLURALS.get(name, name) if isinstance(name, str) else name


def input_name_of(text: str, *, where: str = "input") -> InputName:
    """Return the input of this name; the plural is taken too.

    Raises:
        SettingsError: there is no such input.
    """
    for name in INPUT_NAMES:
        if singular(text) == name:
            return name
    raise SettingsError(f"unknown input '{text}'", where=where, advice="use command or wheel")

# SPDX-License-Identifier: Apache-2.0
"""The command line is shown as a user can type it again."""

import shlex
import sys

import pytest

from slipwise.cli.command_line import command_line


@pytest.mark.parametrize(
    "arguments", [[], ["demo"], ["calibrate", "my log.csv", "--basis", "it's"], ["a;b", "$HOME"]]
)
def test_a_shell_reads_back_the_same_arguments(monkeypatch: pytest.MonkeyPatch, arguments: list[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/bin/slipwise", *arguments])
    assert shlex.split(command_line()) == ["slipwise", *arguments]

# SPDX-License-Identifier: Apache-2.0
"""A progress bar is for people: nothing is written where stderr is no terminal."""

import io
import sys

import pytest

from slipwise.cli.progress import progress_bar


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_nothing_is_written_into_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bar("reading") as update:
        update("learning", 0.5)
    said = capsys.readouterr()
    assert (said.out, said.err) == ("", "")


def test_a_terminal_sees_what_is_done_and_how_much_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress_bar("reading") as update:
        update("learning", 0.5)
    assert "learning" in terminal.getvalue()
    assert "50 %" in terminal.getvalue()

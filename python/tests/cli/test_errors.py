# SPDX-License-Identifier: Apache-2.0
"""Whatever ends a command becomes an exit code and one line."""

from __future__ import annotations

import os
import signal

import pytest

from slipwise.cli.errors import exit_code_of, line_for, printable
from slipwise.errors import SlipwiseError


def test_the_commands_own_code_is_returned() -> None:
    assert [exit_code_of(lambda code=code: code, debug=False) for code in (0, 1)] == [0, 1]


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (SlipwiseError("it is\nbroken", where="here", advice="mend it"), "it is broken (here): mend it"),
        (KeyboardInterrupt(), "stopped by the user; no half-written file is left"),
        (MemoryError(), "out of memory: use a shorter log, or a machine with more memory"),
        (
            OSError(28, "No space left on device", "x"),
            "No space left on device (x): check the path and the disk",
        ),
    ],
)
def test_every_error_is_one_line_and_2(
    error: BaseException, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert line_for(error) == line


def test_an_unexpected_error_asks_for_a_report(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code_of(_fail, debug=False) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "unexpected ValueError: that went wrong" in err
    assert "please report it" in err


def test_debug_shows_the_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code_of(_fail, debug=True) == 2
    assert "in _fail" in capsys.readouterr().err


def test_an_interrupt_that_a_library_turned_into_another_error_is_still_an_interrupt(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def swallowing() -> int:
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None
        return 0

    assert exit_code_of(swallowing, debug=False) == 2
    assert capsys.readouterr().err == "slipwise: stopped by the user; no half-written file is left\n"


def test_the_signal_handlers_are_put_back() -> None:
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    exit_code_of(lambda: 0, debug=False)
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


def test_control_characters_are_replaced() -> None:
    assert printable("a\x1b[2Jb") == "a\N{REPLACEMENT CHARACTER}[2Jb"


def _fail() -> int:
    raise ValueError("that went wrong")

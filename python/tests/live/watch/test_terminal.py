# SPDX-License-Identifier: Apache-2.0
"""A terminal shows a screen and gets its last state; anything else gets lines, few enough for a journal."""

from __future__ import annotations

import io
import threading

from live.sample_outputs import driven_outputs, driven_status, odometry_at, waiting_status
from rich.console import Console

from slipwise.live.outputs import Note
from slipwise.live.watch.terminal import PlainLines, TerminalScreen, state_line, terminal_watcher


def _console(file: io.StringIO, *, terminal: bool) -> Console:
    return Console(
        file=file, force_terminal=terminal, width=80, height=24, color_system=None, _environ={"TERM": "xterm"}
    )


class _Lines:
    """What was printed, and an event for each line."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.printed = threading.Semaphore(0)

    def __call__(self, line: str) -> None:
        self.lines.append(line)
        self.printed.release()


def test_a_terminal_gets_the_screen_and_keeps_the_last_state() -> None:
    file = io.StringIO()
    watcher = terminal_watcher(_console(file, terminal=True), print, headlines=("page: here",))
    assert isinstance(watcher, TerminalScreen)
    for output in driven_outputs():
        watcher.take(output)
    watcher.close()
    watcher.close()
    text = file.getvalue()
    assert text.count("\x1b[?1049h") == text.count("\x1b[?1049l") == 1
    left = text.rpartition("\x1b[?1049l")[2]
    assert "Husky 7" in left
    assert "page: here" in left


def test_what_is_no_terminal_gets_a_line_for_each_note_and_few_of_state() -> None:
    now = 0.0
    lines = _Lines()
    watcher = PlainLines(lines, headlines=("page: here",), clock=lambda: now)
    assert lines.lines == ["page: here"]
    lines.printed.acquire()
    watcher.take(waiting_status(t=1.0))
    assert lines.printed.acquire(timeout=60)
    for i in range(50):
        watcher.take(waiting_status(t=2.0 + i, why=f"status {i}"))
        watcher.take(odometry_at(2.0 + i))
    watcher.take(Note(60.0, "a\x1b[31mnote"))
    assert lines.printed.acquire(timeout=60)
    now = 10.0
    watcher.take(driven_status())
    assert lines.printed.acquire(timeout=60)
    watcher.take(waiting_status(t=70.0))
    watcher.close()
    assert lines.lines == [
        "page: here",
        state_line(waiting_status(t=1.0)),
        "60.0 s  a�[31mnote",
        state_line(driven_status()),
        state_line(waiting_status(t=70.0)),
    ]


def test_no_terminal_is_found_out() -> None:
    lines = _Lines()
    watcher = terminal_watcher(_console(io.StringIO(), terminal=False), lines)
    assert isinstance(watcher, PlainLines)
    watcher.close()
    assert lines.lines == []


def test_a_reader_that_is_gone_does_not_end_the_node() -> None:
    def broken(line: str) -> None:
        raise BrokenPipeError

    watcher = PlainLines(broken)
    for i in range(10):
        watcher.take(Note(float(i), "x"))
    watcher.close()


def test_the_line_of_state_says_what_is_known() -> None:
    line = state_line(driven_status())
    assert line.startswith("40.0 s  learning; model valid: ")
    for part in (
        "position error",
        "baseline",
        "NIS",
        "slip -0.116",
        "5 of 17 parameters estimated",
        "6 left out",
    ):
        assert part in line

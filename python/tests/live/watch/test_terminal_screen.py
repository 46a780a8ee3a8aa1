# SPDX-License-Identifier: Apache-2.0
"""The screen fits terminals of any size, and nothing that a robot is called commands one."""

from __future__ import annotations

import io
import math
from dataclasses import replace

import numpy as np
import pytest
from live.sample_outputs import driven_outputs, driven_status, next_moves, surface_at, waiting_status
from rich.console import Console

from slipwise.live.outputs import Note, Output, ParameterNow
from slipwise.live.watch.history import History
from slipwise.live.watch.terminal_screen import clean, fill_bar, screen

HOSTILE = "[red]\x1b]0;owned\x07\x1b[2J\x9b31m\nb\ud800"


def _lines(width: int, height: int, *outputs: Output) -> list[str]:
    history = History()
    for output in outputs:
        history.take(output)
    console = Console(width=width, height=height, force_terminal=True, color_system=None, file=io.StringIO())
    with console.capture() as captured:
        console.print(screen(history.seen(), console.size, ("page: http://127.0.0.1:8322/",)))
    return captured.get().splitlines()


def _named(lines: list[str], name: str) -> str:
    return next(line for line in lines if line.startswith(name))


def test_it_fits_every_terminal(subtests: pytest.Subtests) -> None:
    for width in [20, 40, 80, 100, 200]:
        for height in [6, 12, 24, 60]:
            with subtests.test(width=width, height=height):
                notes = [Note(float(i), f"note {i} " + "x" * 300) for i in range(20)]
                status = replace(driven_status(), log=tuple((n.t, n.text) for n in notes))
                moves = (status, next_moves())
                for outputs in (driven_outputs(), notes, (status,), (waiting_status(),), moves):
                    lines = _lines(width, height, *outputs)
                    assert max(map(len, lines)) <= width
                    assert len(lines) < height


def test_a_common_terminal_shows_what_matters() -> None:
    lines, status = _lines(80, 24, *driven_outputs()), driven_status()
    assert lines[0] == "page: http://127.0.0.1:8322/"
    assert "Husky 7" in lines[1]
    assert _named(lines, "learning")
    assert status.validity_why in _named(lines, "model estimated")
    assert "m/s" in _named(lines, "slip now")
    assert "(3 expected)" in _named(lines, "NIS")
    assert "baseline" in _named(lines, "held out")
    assert "standstill 3" in _named(lines, "left out")
    assert _named(lines, "ang.w ").split() == [
        "ang.w",
        "-0.29",
        "0.07",
        "0.30",
        "█" * 8,
        "-0.29",
        "estimated",
    ]
    assert "commands from /cmd_vel" in lines[-1]


def test_moves_worth_driving_are_one_line_where_room_is_short_and_three_where_it_is_not() -> None:
    short = _lines(80, 24, *driven_outputs(), next_moves())
    assert _named(short, "next").split("next", 1)[1].strip() == (
        "+1.00 m/s -0.80 rad/s, -0.50 m/s +0.00 rad/s, +0.00 m/s +0.80 rad/s"
    )
    assert "yaw ████▏░░░ ± 0.15 rad, wanted 0.030" in _named(short, "worst")
    high = _lines(120, 40, *driven_outputs(), next_moves())
    begin = high.index(_named(high, "next"))
    assert "forwards 1.00 m/s, turning right 0.80 rad/s, 2 s: yaw ± 0.12 rad" in high[begin]
    assert "backwards 0.50 m/s, straight" in high[begin + 1]
    assert "on the spot, turning left 0.80 rad/s" in high[begin + 2]
    none = _lines(80, 24, *driven_outputs(), next_moves(moves=(), why=HOSTILE))
    assert "\x1b]0" not in _named(none, "next")


def test_a_bar_fills_by_eighths_of_a_character_and_is_blank_where_nothing_is_known() -> None:
    assert [fill_bar(known) for known in (None, 0.0, 0.5, 1.0)] == ["", "░" * 8, "████░░░░", "█" * 8]
    assert fill_bar(0.99) != fill_bar(1.0)


def test_where_room_is_short_the_estimated_parameters_stay() -> None:
    lines, status = _lines(80, 20, *driven_outputs()), driven_status()
    shown = {line.split()[0] for line in lines}
    known = [p.name for p in status.parameters if p.validity == "estimated"]
    assert set(known) <= shown
    assert len(known) < len(status.parameters)
    left = len(status.parameters) - sum(p.name in shown for p in status.parameters)
    assert f"and {left} more" in [line.strip() for line in lines]


def test_a_wide_terminal_has_every_parameter_with_unit_start_and_bar() -> None:
    lines, status = _lines(160, 50, *driven_outputs()), driven_status()
    for p in status.parameters:
        line = _named(lines, f"{p.name} ")
        assert p.unit in line
        assert "●" in line


def test_before_anything_it_waits_and_shows_notes() -> None:
    lines = _lines(80, 24, Note(1.0, "nothing comes on /odom"))
    assert "waiting" in lines[1]
    assert "nothing comes on /odom" in lines[2]


def test_names_command_no_terminal_and_numbers_may_be_missing() -> None:
    p = ParameterNow(HOSTILE, HOSTILE, math.nan, math.inf, 0.0, "invalid", math.nan, math.nan)
    status = waiting_status(
        vehicle=HOSTILE,
        why=HOSTILE,
        validity_why=HOSTILE,
        parameters=(p,),
        counts={HOSTILE: 3},
        log=((math.nan, HOSTILE),),
        slip=np.full(3, math.nan),
        nis=math.nan,
        held_out=(math.nan,) * 4,
    )
    text = "\n".join(_lines(160, 40, status))
    assert not any((ord(c) < 32 and c != "\n") or 0x7F <= ord(c) < 0xA0 for c in text)
    assert "[red]" in text


def test_clean_text_is_one_printable_line() -> None:
    assert clean("a\tb\r\nc\x1b[0m é 机") == "a b  c�[0m é 机"


def test_the_surface_has_a_line_where_surfaces_are_remembered() -> None:
    lines = _lines(80, 24, waiting_status(surface=surface_at(name="s\x1b[31m")))
    assert _named(lines, "surface").split(maxsplit=1)[1].rstrip() == "s�[31m, 90 %"
    assert not any(line.startswith("surface") for line in _lines(80, 24, waiting_status()))

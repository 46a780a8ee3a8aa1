# SPDX-License-Identifier: Apache-2.0
"""Lays the state of the node out on a terminal of any size: what matters most comes first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from slipwise.live.outputs import NextMovesNow, ParameterNow, Status
from slipwise.live.watch.history import Seen
from slipwise.live.watch.status_texts import (
    SLIP_NAMES,
    after_text,
    error_texts,
    move_text,
    nis_text,
    parameter_texts,
    slip_texts,
    stamp_text,
    sure_text,
    surface_text,
)

if TYPE_CHECKING:
    from rich.console import ConsoleDimensions, RenderableType
    from rich.text import Text

_WIDE = 110  # columns from which on the table has all of its columns
_OF_STATE = {"learning": "bold green", "waiting": "bold yellow", "stuck": "bold red"}
_OF_VALIDITY = {"estimated": "green", "unestimated": "yellow", "invalid": "red"}
_RANKS = {"invalid": 0, "estimated": 1, "unestimated": 2}
_HEADS = ("parameter", "value", "± σ", "prior σ", "known", "applied", "validity")
_HEADS_WIDE = (*_HEADS[:1], "unit", "prior -2σ … +2σ", *_HEADS[1:5], "at start", *_HEADS[5:])
_RIGHT = frozenset({"value", "± σ", "prior σ", "at start", "applied"})
_COLOURED = {False: (4, 6), True: (2, 6, 9)}  # columns in the colour of the validity, narrow and wide
_WIDEST_CELL = 26
_LEVELS = "▁▂▃▄▅▆▇█"
_SPARKS = 24  # segments of which the NIS is drawn
_MOST_NOTES = 6
_HIGH = 32  # lines from which on every move worth driving has one of its own
_FILL = 8  # characters of a bar that fills
_EIGHTHS = " ▏▎▍▌▋▊▉█"
_BAR = 21  # characters, odd: the start is in the middle
_BAR_SPAN = 2.0  # standard deviations of the prior to each side


def clean(text: str) -> str:
    """Return text on one line without what would command a terminal."""
    plain = text.encode("utf-8", "replace").decode("utf-8")
    return "".join(
        c if c.isprintable() else " " if c.isspace() else "\N{REPLACEMENT CHARACTER}" for c in plain
    )


def screen(seen: Seen, size: ConsoleDimensions, headlines: Sequence[str] = ()) -> RenderableType:
    """Return what fits into the terminal; the table of parameters is cut first."""
    from rich.console import Group

    width = max(size.width, 20)
    top = [_line([(clean(line), "cyan")], width) for line in headlines]
    status = seen.status
    if status is None:
        top.append(_line([("waiting", "bold yellow"), ("  no samples yet", "")], width))
        notes = _notes(seen, max(size.height - len(top) - 2, 0), width)
        return Group(*top, *notes)
    top += _head(status, width) + _numbers(seen, status, width)
    if seen.next_moves is not None:
        top += _next_moves(seen.next_moves, width, high=size.height >= _HIGH)
    free = max(size.height - len(top) - 1, 0)  # the last line stays empty: a terminal scrolls after it
    notes = _notes(seen, min(_MOST_NOTES, max(free // 4, 1), free), width)
    rows = free - len(notes)
    table = _parameters(status.parameters, rows, width) if rows >= 3 else []
    return Group(*top[: size.height - 1], *table, *notes)


def _head(status: Status, width: int) -> list[Text]:
    facts = [
        f"slipwise live  {clean(status.vehicle)}",
        f"from {clean(status.input)}s",
        f"apply {status.apply}",
    ]
    right = stamp_text(status.t)
    left = "  ·  ".join(facts)
    room = max(width - len(right) - 2, 1)
    return [
        _line([(left[:room].ljust(room), "bold"), (f"  {right}", "")], width),
        _line([(clean(status.state), _OF_STATE.get(status.state, "bold")), (_why(status.why), "")], width),
        _line(
            [
                (f"model {status.validity}", f"bold {_OF_VALIDITY.get(status.validity, '')}".strip()),
                (_why(status.validity_why), ""),
            ],
            width,
        ),
    ]


def _why(text: str) -> str:
    return f"  {clean(text)}" if text else ""


def _numbers(seen: Seen, status: Status, width: int) -> list[Text]:
    slip = slip_texts(status)
    moved = (
        "–"
        if slip is None
        else "   ".join(f"{name} {text} {unit}" for (name, unit), text in zip(SLIP_NAMES, slip, strict=True))
    )
    errors = "   ".join(f"{e.name} {e.learned} {e.unit} (baseline {e.baseline})" for e in error_texts(status))
    pose = "" if status.odometry is None else f"   last pose {status.odometry.since_pose:.1f} s ago"
    counts = sorted(status.counts.items(), key=lambda item: -item[1])
    left_out = ", ".join(f"{clean(reason)} {count}" for reason, count in counts if count)
    facts = {
        "slip now": moved,
        "NIS": f"{nis_text(status)} (3 expected)  {_sparkline(seen)}",
        "held out": errors or "no window yet",
        "segments": f"{status.segments}{pose}",
        "left out": left_out or "nothing",
    }
    if status.surface is not None:
        facts["surface"] = clean(surface_text(status))
    return [_line([(f"{name:<10}", "dim"), (text, "")], width) for name, text in facts.items()]


def _next_moves(now: NextMovesNow, width: int, *, high: bool) -> list[Text]:
    """Return how sure the worst prediction is, and what to drive: a line each, or all in one."""
    sure = "   ".join(f"{s.name} {fill_bar(s.known)} {sure_text(s)}" for s in now.predictions)
    facts = [("worst σ", sure)] if sure else []
    if not now.moves:
        facts.append(("next", clean(now.why)))
    elif high:
        heads = ("next", *[""] * (len(now.moves) - 1))
        facts += [
            (head, f"{move_text(m)}, {m.seconds:g} s: {after_text(m)}; {clean(m.teaches)}")
            for head, m in zip(heads, now.moves, strict=True)
        ]
    else:
        facts.append(("next", ", ".join(f"{m.v:+.2f} m/s {m.omega:+.2f} rad/s" for m in now.moves)))
    return [_line([(f"{name:<10}", "dim"), (text, "")], width) for name, text in facts]


def fill_bar(known: float | None) -> str:
    """Draw a bar that fills from 0 to 1; blank where nothing is known of it."""
    if known is None:
        return ""
    eighths = min(int(known * 8 * _FILL), 8 * _FILL)
    whole, rest = divmod(eighths, 8)
    bar = "█" * whole + (_EIGHTHS[rest] if rest else "")
    return bar.ljust(_FILL, "░")


def _sparkline(seen: Seen) -> str:
    """Draw the last NIS on a logarithmic scale from 0.1 to 30."""
    values = [min(max(value, 0.1), 30.0) for _, value in seen.nis[-_SPARKS:]]
    most = len(_LEVELS) - 1
    return "".join(_LEVELS[round(most * math.log(value / 0.1) / math.log(300.0))] for value in values)


def _notes(seen: Seen, most: int, width: int) -> list[Text]:
    return [
        _line([(f"{stamp_text(t):>9}  ", "dim"), (clean(text), "")], width)
        for t, text in reversed(seen.notes[:most])
    ]


def _parameters(parameters: Sequence[ParameterNow], rows: int, width: int) -> list[Text]:
    """Return the table in at most `rows` lines with its heading, and how many parameters it leaves out."""
    if not parameters:
        return []
    room = rows - 1  # without its heading
    shown = parameters
    if len(parameters) > room:  # what says most comes first
        shown = sorted(parameters, key=lambda p: _RANKS.get(p.validity, 0))[: max(room - 1, 0)]
    wide = width >= _WIDE
    table = [_HEADS_WIDE if wide else _HEADS, *(_cells(p, wide=wide) for p in shown)]
    columns = list(zip(*table, strict=True))
    padded = [_padded(column, right=column[0] in _RIGHT) for column in columns]
    lines = [_line([("  ".join(row[0] for row in padded), "bold underline")], width)]
    for i, p in enumerate(shown, start=1):
        colour = _OF_VALIDITY.get(p.validity, "")
        cells = [
            (column[i] + "  ", colour if k in _COLOURED[wide] else "") for k, column in enumerate(padded)
        ]
        lines.append(_line(cells, width))
    left = len(parameters) - len(shown)
    return [*lines, *([_line([(f"and {left} more", "dim")], width)] if left else [])]


def _cells(p: ParameterNow, *, wide: bool) -> tuple[str, ...]:
    texts = parameter_texts(p)
    name = clean(texts.name)
    if wide:
        unit = clean(texts.unit)
        return (
            name,
            unit,
            _bar(p),
            texts.value,
            texts.std,
            texts.prior,
            fill_bar(p.known),
            texts.start,
            texts.applied,
            p.validity,
        )
    return (name, texts.value, texts.std, texts.prior, fill_bar(p.known), texts.applied, p.validity)


def _padded(cells: Sequence[str], *, right: bool) -> list[str]:
    """Return the cells of a column, as wide as the widest of them."""
    from rich.cells import cell_len, set_cell_size

    cut = [
        cell if cell_len(cell) <= _WIDEST_CELL else set_cell_size(cell, _WIDEST_CELL - 1) + "…"
        for cell in cells
    ]
    width = max(map(cell_len, cut))
    return [" " * (width - cell_len(c)) + c if right else c + " " * (width - cell_len(c)) for c in cut]


def _bar(p: ParameterNow) -> str:
    """Draw value and standard deviation on a scale of the prior's, about the value at the start."""
    half = _BAR // 2
    cells = [" "] * half + ["|"] + [" "] * half
    if not (p.prior_std > 0.0 and math.isfinite(p.prior_std) and math.isfinite(p.value + p.std + p.start)):
        return "".join(cells)

    def place(value: float) -> int:
        steps = (value - p.start) / p.prior_std / _BAR_SPAN * half
        return half + round(min(max(steps, -half), half))

    for i in range(place(p.value - p.std), place(p.value + p.std) + 1):
        cells[i] = "─"
    cells[place(p.value)] = "●"
    return "".join(cells)


def _line(parts: Sequence[tuple[str, str]], width: int) -> Text:
    """Return one line of text, cut where the terminal ends."""
    from rich.text import Text

    line = Text.assemble(*parts, no_wrap=True, overflow="ellipsis")
    line.truncate(width, overflow="ellipsis")
    return line

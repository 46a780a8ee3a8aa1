# SPDX-License-Identifier: Apache-2.0
"""Where the clock of a recording was set back: several stamps in a row are behind, and agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise.logs.log import Floats, Ints
from slipwise.logs.stamps import lone_spikes

BACK = 1.0  # s behind the newest stamp; streams are late by less, and delayed ones are never set back
AGREE = 1.0  # s within which stamps confirm each other
ENOUGH = 5  # stamps in a row that are behind: the clock was set back
TOGETHER = 5.0  # s of arrival within which steps of several streams are one


@dataclass(frozen=True, eq=False)
class Arrivals:
    """Stamps of one stream in the order in which they arrived."""

    order: Floats  # [N] where each stands among those of all streams: s of receipt, or the number of a row
    t: Floats  # [N] s


@dataclass(frozen=True)
class ClockStep:
    """A clock that was set back."""

    order: float  # of the first stamp after it
    seconds: float  # by how much


def steps_back(t: Floats) -> Ints:
    """Return where stamps [N] of one stream are set back for good: the first stamp of each stretch.

    A lone stamp far ahead, which the next ones take back, sets no clock; nor do stamps that were never set.
    """
    steady = t[np.isfinite(t)]
    places = np.flatnonzero(np.isfinite(t))
    kept = ~lone_spikes(steady)
    steady, places = steady[kept], places[kept]
    found: list[int] = []
    begin = 0
    newest = -np.inf
    for drop in (np.flatnonzero(np.diff(steady) < 0.0) + 1).tolist():
        newest = max(newest, float(steady[begin:drop].max(initial=-np.inf)))
        after = steady[drop : drop + ENOUGH]
        ahead = np.diff(after)
        agree = ((ahead >= 0.0) & (ahead <= AGREE)).all() and ahead.any()
        if len(after) == ENOUGH and agree and (after < newest - BACK).all():
            found.append(int(places[drop]))
            newest = -np.inf
        begin = drop
    return np.array(found, dtype=np.int64)


def clock_steps(streams: Sequence[Arrivals], together: float = TOGETHER) -> tuple[ClockStep, ...]:
    """Return the steps back of all streams in the order of arrival; those of several at once are one.

    Args:
        streams: stamps of each.
        together: how far apart in their order steps of several streams may be that are one.
    """
    firsts = sorted(
        (float(stream.order[place]), _amount(stream.t, place))
        for stream in streams
        for place in steps_back(stream.t).tolist()
    )
    found: list[ClockStep] = []
    for order, seconds in firsts:
        if found and order <= found[-1].order + together:
            found[-1] = ClockStep(found[-1].order, max(found[-1].seconds, seconds))
        else:
            found.append(ClockStep(order, seconds))
    return tuple(found)


def part_of(stream: Arrivals, steps: Sequence[float], together: float = TOGETHER) -> Ints:
    """Return in which part each arrival [N] lies: a stream that was set back a little later ends there.

    Args:
        stream: of the recording.
        steps: the order at which each part but the first begins.
        together: as `clock_steps` takes it.
    """
    part = np.searchsorted(np.asarray(steps, dtype=np.float64), stream.order, side="right")
    for place in steps_back(stream.t).tolist():
        number = int(part[place])
        if number and stream.order[place] <= steps[number - 1] + together:
            part[:place] = np.minimum(part[:place], number - 1)
    return np.asarray(part, dtype=np.int64)


def _amount(t: Floats, place: int) -> float:
    """By how much the stamp at a place is behind the newest before [s]."""
    before = t[:place]
    return float(before[np.isfinite(before)][-ENOUGH:].max() - t[place])

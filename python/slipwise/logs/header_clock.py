# SPDX-License-Identifier: Apache-2.0
"""Compares header stamps with the time of receipt, stream by stream: offset and rate of their clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from slipwise.logs.findings.clocks import ClockApart, ClockOfTopic, ClockRate, ClockSlewed, NoClock
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import Floats

AHEAD = 0.02  # s; no message is stamped later than it is received: from here on its clock is ahead
LATENCY = 1.0  # s; no sensor takes so long: beyond it the clock is behind
_SHARED = 0.5  # s by which streams on one clock may be delayed differently
_PROMPT = 0.05  # s; headers that are as close to receipt as this are on the bag's clock
_COPIED = 1e-5  # s; headers all as close to receipt are copies of it, by a program that converts
_FEWEST = 10  # messages,
_SHORTEST = 2.0  # s of them, below which no rate is measured
_DRIFT = 0.05  # s over the recording from which on a rate of its own is seen,
_CERTAIN = 4.0  # times the scatter of the delays
_SLOWEST, _FASTEST = 0.01, 100.0  # rates of simulations
_UNSTEADY = 0.1  # of the recording; stamps that scatter by more follow no clock
_SLEWED = 0.1  # s by which clocks of one rate move against each other over a recording: more than delays do
_LEAST_DELAYED = 0.95  # quantile; a few stamps may be wrong
_PIECES = 60  # of a recording, in which the least delayed message is looked for
SIMULATED = 0.005  # a rate so far from 1 is no drift of an oscillator: time is simulated


@dataclass(frozen=True, eq=False)
class HeaderClock:
    """The clock of headers against that of receipt: header = receipt + `lead` at knots, linear between."""

    knots: Floats  # [K] s of receipt
    lead: Floats  # [K] s, header minus receipt of the least delayed messages
    rate: float  # s of the headers in a second of receipt

    def at(self, received: Floats) -> Floats:
        """Return what a header would say at a time of receipt [N]."""
        first, last = self.knots[0], self.knots[-1]
        beyond = np.minimum(received - first, 0.0) + np.maximum(received - last, 0.0)
        return np.asarray(received + np.interp(received, self.knots, self.lead) + (self.rate - 1.0) * beyond)

    @property
    def offset(self) -> float:
        """By how much headers are ahead of receipt in the middle of the recording [s]."""
        return float(np.median(self.lead))

    @property
    def moves(self) -> float:
        """By how much it moves against that of receipt over the recording [s]."""
        return (self.rate - 1.0) * float(self.knots[-1] - self.knots[0])

    @property
    def simulated(self) -> bool:
        """Whether time runs at another rate than the recorder's clock."""
        return abs(self.rate - 1.0) > SIMULATED

    @property
    def apart(self) -> bool:
        """Whether it is another clock than the recorder's; a delay is none."""
        return self.simulated or is_apart(self.offset)

    def moved(self, seconds: float) -> HeaderClock:
        """Return a clock that is ahead by as much more."""
        return HeaderClock(self.knots, self.lead + seconds, self.rate)


def is_apart(lead: float) -> bool:
    """Say whether headers that are ahead of receipt by `lead` [s] are on another clock; a delay is none."""
    return lead > AHEAD or lead < -LATENCY


def compare_clocks(received: Floats, stamps: Floats) -> HeaderClock | None:
    """Return the clock of stamps [N] against times of receipt [N], both in s; None where they follow none."""
    if len(stamps) == 0:
        return None
    order = np.argsort(received, kind="stable")
    r, s = received[order], stamps[order]
    span = float(r[-1] - r[0])
    if len(r) < _FEWEST or span < _SHORTEST:
        return HeaderClock(r[:1], np.array([_least_delayed(s - r)]), 1.0)
    slope, middle = np.polyfit(r - r[0], s - s[0], 1)
    scatter = float(np.std(s - s[0] - middle - slope * (r - r[0])))
    if scatter > _UNSTEADY * max(span, float(np.ptp(s))) or not _SLOWEST < slope < _FASTEST:
        return None
    if abs(slope - 1.0) * span < max(_DRIFT, _CERTAIN * scatter):
        return HeaderClock(r[:1], np.array([_least_delayed(s - r)]), 1.0)
    knots, lead = _envelope(r, s - r, float(slope))
    return HeaderClock(knots, lead, float(slope))


def _least_delayed(lead: Floats) -> float:
    return float(np.quantile(lead, _LEAST_DELAYED))


def _envelope(r: Floats, lead: Floats, rate: float) -> tuple[Floats, Floats]:
    """Return receipt and lead of the first, the last, and the least delayed message of each piece."""
    rest = lead - (rate - 1.0) * (r - r[0])
    edges = np.linspace(r[0], r[-1], _PIECES + 1)[1:-1]
    pieces = np.split(np.arange(len(r)), np.searchsorted(r, edges))
    best = np.array([0, *(part[np.argmax(rest[part])] for part in pieces if len(part)), len(r) - 1])
    knots, first = np.unique(r[best], return_index=True)
    return knots, lead[best][first]


@dataclass(frozen=True)
class BagClocks:
    """What the headers of all streams say of their clocks, and how each stream is dated."""

    main: HeaderClock | None  # of the poses, or of whatever has headers; None: the recorder's
    shifts: Mapping[str, float]  # s added to the stamps of topics on another clock
    received: frozenset[str] = frozenset()  # topics whose stamps follow no clock, or one of another rate
    slewed: Mapping[str, float] = field(default_factory=dict)  # s that topics move against the poses' clock
    compared: bool = False  # whether headers and receipt tell anything of each other

    def by_receipt(self, received: Floats) -> Floats:
        """Date messages [N] without a header, of which the time of receipt [s] is known."""
        main = self.main
        return received if main is None or not main.apart else main.at(received)

    def dates(self, topic: str, received: Floats, stamps: Floats) -> Floats:
        """Date messages [N] with headers, from the times of receipt and the stamps [s] of their topic."""
        if topic in self.received:
            return self.by_receipt(received)
        shift = self.shifts.get(topic, 0.0)
        return stamps + shift if shift else stamps

    def said(self, unstamped: Sequence[str]) -> tuple[str | Finding, ...]:
        """Say what was found, and how topics without headers are dated."""
        names, main = " and ".join(unstamped), self.main
        dated = f": {names}, without a header, gets their clock" if unstamped else ""
        if main is not None and main.simulated:
            said: list[str | Finding] = [ClockRate.by(main.rate, dated)]
        elif main is not None and main.apart:
            said = [ClockApart.by(main.offset, "the bag", dated)]
        else:
            how = "has no header: its commands get the time of receipt"
            said = [f"{name} {how}" for name in unstamped]
        said += [ClockOfTopic.by(topic, seconds) for topic, seconds in self.shifts.items()]
        said += [ClockSlewed.by(topic, seconds) for topic, seconds in self.slewed.items()]
        said += [NoClock.of(topic) for topic in sorted(self.received)]
        return tuple(said)


def clocks_of(
    streams: Mapping[str, tuple[Floats, Floats]],
    first: str | None,
    clock: tuple[Floats, Floats] | None = None,
) -> BagClocks:
    """Compare headers and receipt of every stream.

    Args:
        streams: times of receipt and stamps [s] of each topic that has headers.
        first: the topic whose clock all is dated on; another where it has no headers.
        clock: the same of /clock, which tells a simulation's time.
    """
    found = {name: compare_clocks(*pair) for name, pair in streams.items() if len(pair[0])}
    known = {name: each for name, each in found.items() if each is not None}
    if not known or (first in found and first not in known):
        return BagClocks(None, {}, frozenset(found))
    main = known.get(first or "") or next(iter(known.values()))
    alike = {name: each for name, each in known.items() if abs(each.rate - main.rate) <= SIMULATED}
    lost = frozenset(found) - frozenset(alike)
    shifts = {name: _between(main, each) for name, each in alike.items()}
    moves = {name: each.moves - main.moves for name, each in alike.items()}
    slewed = {name: by for name, by in moves.items() if abs(by) > _SLEWED and not main.simulated}
    clock_offset = compare_clocks(*clock) if clock is not None and main.simulated else None
    if clock_offset is not None and abs(clock_offset.rate - main.rate) <= SIMULATED:
        main = clock_offset
    elif not main.simulated:  # the least delayed of the streams on its clock tells it best
        leads = [each.offset for name, each in alike.items() if not shifts[name]]
        main = main.moved(max(leads) - main.offset)
    copied = all(np.abs(r - s).max() < _COPIED for r, s in streams.values() if len(r))
    shifted = {name: shift for name, shift in shifts.items() if shift}
    return BagClocks(main, shifted, lost, slewed, not copied)


def _between(main: HeaderClock, other: HeaderClock) -> float:
    """By how much the main clock is ahead of another [s]; what delays of their streams explain is none."""
    return 0.0 if main.simulated else clock_between(main.offset, other.offset)


def clock_between(main: float, other: float) -> float:
    """By how much a clock is ahead of another [s], by their leads over receipt; what delays explain is 0."""
    first, second = (lead if is_apart(lead) else 0.0 for lead in (main, other))
    one_is_the_bags = min(abs(main), abs(other)) <= _PROMPT
    least = AHEAD + _PROMPT if one_is_the_bags and max(first, second) > AHEAD else _SHARED
    return first - second if abs(first - second) > least else 0.0

# SPDX-License-Identifier: Apache-2.0
"""Stamps of messages: those of their headers; messages without one are dated by the clock of the others."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import deque
from collections.abc import Callable
from typing import Any

from slipwise.logs.clock_steps import BACK, ENOUGH
from slipwise.logs.findings.clocks import ClockApart, ClockOfTopic
from slipwise.logs.header_clock import LATENCY, clock_between, is_apart

LOOKED_AT = 200  # messages with a header, of late
_STEADY = 0.3  # s that delays differ by; more is another rate of the clock
_FEWEST = 20  # of a topic, before its clock counts as another than that of the poses


def _nobody(_: str) -> None:
    """Has no listener."""


def seconds_of(stamp: Any) -> float:
    """Return a stamp [s], rounded as that of a bag is: a played bag teaches the bytes that it holds."""
    return float(int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)) / 1e9


class Stamps:
    """Dates messages [s], as those of a bag are dated.

    Args:
        first: the topic whose clock all is dated on; another where it has no headers.
        say: called with clocks that are apart.
    """

    def __init__(self, first: str = "", say: Callable[[str], None] = _nobody) -> None:
        self.simulated = False  # whether /clock gives the time
        self._now = float("nan")  # s, of /clock
        self._first, self._say = first, say
        self._clocks: dict[str, _Lead] = {}  # of each topic with headers
        self._shifts: dict[str, float] = {}  # s added to the stamps of a topic
        self._said = False

    def take_clock(self, clock: Any) -> None:
        """Take the time that /clock has."""
        self._now = seconds_of(clock)

    def of(self, message: Any, arrived: float, topic: str = "") -> float:
        """Return the stamp of a message of a topic that arrived at a time [s since 1970].

        Without a header it is the time of /clock; else that of arrival, on the clock of the headers where
        these differ: the least delayed of them says by how much.
        """
        header = getattr(message, "header", None)
        if header is not None and (header.stamp.sec or header.stamp.nanosec):
            t = seconds_of(header.stamp)
            self._clocks.setdefault(topic, _Lead()).take(t - arrived)
            return t + self._shift(topic)
        if self.simulated:
            return self._now
        main = self._main()
        if main is None or not is_apart(main.lead):
            return arrived
        if not self._said and main.steady:
            self._said = True
            dated = ": messages without a header get their clock"
            self._say(ClockApart.by(main.lead, "this computer", dated).sentence)
        return arrived + main.lead

    @property
    def compared(self) -> bool:
        """Whether headers were compared with the times of arrival: a long delay is then one of the robot."""
        return bool(self._clocks) and (self.simulated or all(each.known for each in self._clocks.values()))

    def _main(self) -> _Lead | None:
        return self._clocks.get(self._first) or next(iter(self._clocks.values()), None)

    def _shift(self, topic: str) -> float:
        """Return what is added to the stamps of a topic that is on another clock than the poses [s]."""
        own, main = self._clocks[topic], self._main()
        if self.simulated or main is None or main is own or not (own.steady and main.steady):
            return self._shifts.get(topic, 0.0)
        found, before = clock_between(main.lead, own.lead), self._shifts.get(topic, 0.0)
        if abs(found - before) > BACK or bool(found) != bool(before):
            self._shifts[topic] = found
            if found:
                self._say(ClockOfTopic.by(topic, found).sentence)
        return self._shifts.get(topic, 0.0)


class _Lead:
    """How far the headers of a topic are ahead of their arrival, by the least delayed of late."""

    def __init__(self) -> None:
        self._leads: deque[float] = deque()
        self._sorted: list[float] = []  # the same, the least first: one goes and one comes with each message
        self._odd: list[float] = []  # that do not go with these: several in a row are a clock that was set
        self.lead = 0.0  # s; of a clock that runs at another rate the newest
        self.steady = False  # the clock runs at the rate of this computer's
        self.known = False  # by less than a sensor may take

    def take(self, lead: float) -> None:
        if self._leads and abs(lead - self._median()) > BACK:
            self._odd.append(lead)
            if len(self._odd) < ENOUGH:
                return
            self._leads, self._sorted = deque(self._odd), sorted(self._odd)
        else:
            self._keep(lead)
        self._odd = []
        enough, spread = len(self._leads) >= _FEWEST, self._sorted[-1] - self._sorted[0]
        self.steady, self.known = enough and spread < _STEADY, enough and spread < LATENCY
        self.lead = self._sorted[-1] if self.steady or len(self._leads) < _FEWEST else lead

    def _keep(self, lead: float) -> None:
        if len(self._leads) == LOOKED_AT:
            del self._sorted[bisect_left(self._sorted, self._leads.popleft())]
        self._leads.append(lead)
        insort(self._sorted, lead)

    def _median(self) -> float:
        half, odd = divmod(len(self._sorted), 2)
        return self._sorted[half] if odd else (self._sorted[half - 1] + self._sorted[half]) / 2.0

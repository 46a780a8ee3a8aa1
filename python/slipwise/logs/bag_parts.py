# SPDX-License-Identifier: Apache-2.0
"""Cuts what was taken out of a bag where its clock was set back or a file is missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from slipwise.logs.clock_steps import Arrivals, clock_steps, part_of
from slipwise.logs.findings.clocks import ClockSetBack
from slipwise.logs.findings.finding import Finding
from slipwise.logs.header_clock import BagClocks, clocks_of
from slipwise.logs.log import Floats, Ints
from slipwise.logs.messages import Samples, select
from slipwise.logs.transforms import TransformCollector

_SILENCE = 2.0  # s without any message, where a file of the bag is missing


@dataclass(frozen=True)
class Collected:
    """Everything taken out of a bag, or out of a part of it."""

    samples: Mapping[str, Samples]  # by role: command, wheel, pose, imu
    transforms: TransformCollector
    runs: tuple[tuple[int, str], ...]  # start [ns] and name
    clock: tuple[Ints, Ints] | None = None  # times of receipt and stamps [ns] of /clock

    @property
    def starts(self) -> Floats:
        """When each run but the first begins [s]."""
        return np.array([start for start, _ in self.runs][1:], dtype=np.int64) / 1e9

    def compared_clocks(self, first: str | None) -> BagClocks:
        """Compare headers and receipt of all streams; `first` is the topic whose clock all is dated on."""
        streams = {}
        for samples in self.samples.values():
            dated = samples.stamp_ns != 0
            if samples.has_header and dated.any():
                pair = samples.received_ns[dated] / 1e9, samples.stamp_ns[dated] / 1e9
                streams[samples.topic] = pair
        clock = None if self.clock is None else (self.clock[0] / 1e9, self.clock[1] / 1e9)
        return clocks_of(streams, first, clock)


def parts_of(
    collected: Collected, *, file_missing: bool
) -> tuple[tuple[Collected, ...], tuple[str | Finding, ...]]:
    """Return the parts of a bag in the order of receipt, and what begins each but the first, in words.

    Args:
        collected: from the whole bag.
        file_missing: a file of the bag is not there, so that a silence may hold a drive.
    """
    named = _arrivals(collected)
    steps = clock_steps(list(named.values()))
    begins: dict[float, str | Finding] = {step.order: ClockSetBack.by(step.seconds) for step in steps}
    if file_missing:
        begins |= _silences(named)
    if not begins:
        return (collected,), ()
    order = sorted(begins)
    whole = {name: part_of(arrivals, order) for name, arrivals in named.items()}
    parts = tuple(_part(collected, whole, number) for number in range(len(order) + 1))
    return parts, tuple(begins[each] for each in order)


_Key = tuple[str, ...]  # a role, or the two frames of a transform


def _arrivals(collected: Collected) -> dict[_Key, Arrivals]:
    """Return receipt and stamps of each stream; NaN where there is no stamp."""
    found: dict[_Key, Arrivals] = {}
    for role, samples in collected.samples.items():
        stamps = np.where(samples.stamp_ns == 0, np.nan, samples.stamp_ns / 1e9)
        found[(role,)] = Arrivals(samples.received_ns / 1e9, stamps)
    for edge, moves in collected.transforms.arrived().items():
        if not collected.transforms.is_static(edge):
            found[edge] = Arrivals(moves.received / 1e9, moves.stamps / 1e9)
    if collected.clock is not None:
        found[("/clock",)] = Arrivals(collected.clock[0] / 1e9, collected.clock[1] / 1e9)
    return found


def _silences(named: Mapping[_Key, Arrivals]) -> dict[float, str]:
    """Return when messages come again after a silence of all streams [s], and what is to be said."""
    received = np.sort(np.concatenate([np.empty(0), *(arrivals.order for arrivals in named.values())]))
    gaps = np.flatnonzero(np.diff(received) > _SILENCE)
    again, long = received[gaps + 1].tolist(), np.diff(received)[gaps].tolist()
    words = "nothing was recorded for {:.1f} s: a new run begins"
    return {t: words.format(seconds) for t, seconds in zip(again, long, strict=True)}


def _part(collected: Collected, whole: Mapping[_Key, Ints], number: int) -> Collected:
    samples = {role: select(own, whole[(role,)] == number) for role, own in collected.samples.items()}
    edges = {edge: parts == number for edge, parts in whole.items() if len(edge) == 2}
    clock = collected.clock
    if clock is not None:
        kept = whole[("/clock",)] == number
        clock = (clock[0][kept], clock[1][kept])
    kept_edges = {(edge[0], edge[1]): kept for edge, kept in edges.items()}
    return replace(collected, samples=samples, transforms=collected.transforms.part(kept_edges), clock=clock)

# SPDX-License-Identifier: Apache-2.0
"""Counts, rates, durations and gaps of the streams of a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs import Log
from slipwise.segments import WindowRules

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stream:
    """One stream over all runs of a log; what is not known is NaN."""

    name: str  # "commands", "wheels" or "poses"
    runs: int  # that have it
    samples: int
    seconds: float  # s, from first to last sample, added up over the runs
    rate: float  # [Hz] one over the median interval
    gaps: int  # intervals after which inputs are unknown or a pose is late
    longest_gap: float  # s, the longest interval
    frames: int  # that poses are comparable in; 0 for inputs


def streams_of(log: Log, rules: WindowRules) -> tuple[Stream, ...]:
    """Return the streams that a log has, commands first."""
    found = []
    for name in ("commands", "wheels", "poses"):
        stamps: list[Floats] = []
        frames = 0
        for run in log.runs:
            series = {"commands": run.commands, "wheels": run.wheels, "poses": run.poses}[name]
            if series is not None and len(series):
                stamps.append(series.t)
                frames += len(np.unique(run.poses.frame)) if name == "poses" else 0
        if stamps:
            found.append(_stream(name, stamps, frames, rules))
    return tuple(found)


def _stream(name: str, stamps: Sequence[Floats], frames: int, rules: WindowRules) -> Stream:
    intervals = np.concatenate([np.diff(t) for t in stamps])
    usual = float(np.median(intervals)) if len(intervals) else float("nan")
    allowed = rules.late_factor * usual if name == "poses" else rules.unknown_after
    return Stream(
        name=name,
        runs=len(stamps),
        samples=sum(len(t) for t in stamps),
        seconds=float(sum(t[-1] - t[0] for t in stamps)),
        rate=1.0 / usual if usual > 0.0 else float("nan"),
        gaps=int(np.count_nonzero(intervals > allowed)) if len(intervals) else 0,
        longest_gap=float(intervals.max()) if len(intervals) else float("nan"),
        frames=frames,
    )

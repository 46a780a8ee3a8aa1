# SPDX-License-Identifier: Apache-2.0
"""One time axis for all runs of a log: run after run, without the pauses between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Log
from slipwise.reporting.figure import vertical_lines

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_MOST_BOUNDARIES = 20  # more lines than this would hide the curves


@dataclass(frozen=True, eq=False)
class Timeline:
    """Where each run starts, in its own clock and on the common axis, [runs] each, in s."""

    first: Floats
    offset: Floats

    @classmethod
    def of(cls, log: Log) -> Timeline:
        """Lay the runs of a log one after the other."""
        spans = np.array([run.span for run in log.runs], dtype=np.float64).reshape(-1, 2)
        lengths = spans[:, 1] - spans[:, 0]
        return cls(spans[:, 0], np.concatenate([[0.0], np.cumsum(lengths)[:-1]]) if len(lengths) else lengths)

    @property
    def title(self) -> str:
        """The title of the axis."""
        return "time [s]" if len(self.first) <= 1 else "time, runs one after another [s]"

    def at(self, run: Ints, t: Floats) -> Floats:
        """Return the common time [N] of times `t` [N] in the runs with index `run` [N]."""
        if not len(self.first):
            return np.asarray(t)
        place = np.clip(run, 0, len(self.first) - 1)
        return np.asarray(t - self.first[place] + self.offset[place])

    def seconds(self, run: int, t: float) -> float:
        """Return the common time of one time `t` in a run."""
        return float(self.at(np.array([run]), np.array([t]))[0])

    def shapes(self) -> list[dict[str, Any]]:
        """Return a thin vertical line where each later run starts, none where there are too many."""
        starts = self.offset[1:].tolist()
        if len(starts) > _MOST_BOUNDARIES:
            return []
        return vertical_lines(starts, "#9aa5b1", dash="dot", width=1.0)


def with_breaks(run: Ints, values: Floats) -> Floats:
    """Insert NaN [N + changes] where the run [N] changes, so that a line is not drawn across."""
    return np.insert(np.asarray(values, dtype=np.float64), np.flatnonzero(np.diff(run)) + 1, np.nan)

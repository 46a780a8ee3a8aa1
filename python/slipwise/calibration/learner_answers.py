# SPDX-License-Identifier: Apache-2.0
"""What a learner has to say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise import _core

_KINDS = {
    _core.EventKind.SegmentLearned: "segment-learned",
    _core.EventKind.Rejected: "rejected",
    _core.EventKind.TerrainChange: "terrain-change",
    _core.EventKind.HeldOut: "held-out",
    _core.EventKind.Refit: "refit",
}


@dataclass(frozen=True)
class Event:
    """Something that a learner has to say."""

    kind: str  # "segment-learned", "rejected", "terrain-change", "held-out" or "refit"
    run: str
    t: float  # s
    reason: str = ""  # why something was rejected
    nis: float | None = None  # of a segment learned: its normalised innovation squared, 3 degrees of freedom


def event_of(event: _core.LearnerEvent, run: str) -> Event:
    """Return an event of the core, in the run of that name, in words."""
    kinds = _core.EventKind
    return Event(
        _KINDS[event.kind],
        run,
        event.t,
        event.reason_text if event.kind == kinds.Rejected else "",
        _nis(event) if event.kind == kinds.SegmentLearned else None,
    )


def _nis(event: _core.LearnerEvent) -> float:
    """The NIS of the structure that predicts."""
    return float(event.updates[int(np.argmax(event.weights))].nis)

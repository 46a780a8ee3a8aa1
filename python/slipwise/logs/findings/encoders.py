# SPDX-License-Identifier: Apache-2.0
"""Finds what encoders do wrong: samples that jump, as a counter does that wraps or is reset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Log, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_FEWEST = 100  # samples, before a spike among them is told
_USUAL = 0.8  # quantile of sizes that are no spikes
_FAR = 6.0  # times the usual size, and the neighbours'
_LEAST = 0.02  # m/s or rad/s, below which speeds are those of a robot that stands
_CURE = "Unwrap the counter (16 bits, pi, 2 pi) in the driver, or publish velocities."
_LEFT = "absurd-speed"  # kind of what a reader leaves out


class WheelSpikes(Check):
    """Single speeds of wheels that no robot can have."""

    kind, family, spoils = "wheel-spikes", "encoders", False
    hidden_by = ()
    means = "a counter wraps (16 bits, pi, 2 pi) or is reset, or ticks jump: speeds far beyond all others"
    shows = "single samples 6 times as fast as their neighbours and as four fifths of all"
    cure = "unwrap the counter in the driver; those 15 times as fast as all before are left out"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at what was left out of the wheels, and at what was not."""
        left = [e for e in whole.log.left_out if e.kind == _LEFT and e.reason.startswith("wheels")]
        kept = self.kept(whole.log)
        if not left:
            return kept
        count = sum(each.count for each in left)
        return self.found(
            f"{count} wheel speeds jump far beyond all others for one sample (first at {left[0].where}): a "
            "counter wraps or is reset",
            f"They are left out{', others are not' if kept else ''}. {_CURE}",
            evidence=count,
        )

    @classmethod
    def kept(cls, log: Log) -> Finding | None:
        """Look at what was not left out."""
        spikes = [spike for run in log.runs for spike in _spikes(run)]
        if not spikes:
            return None
        return cls.found(
            f"{len(spikes)} wheel speeds jump far beyond all others for one sample (first at {spikes[0]}): a "
            "counter wraps or is reset",
            _CURE,
            evidence=len(spikes),
        )


def _spikes(run: Run) -> list[str]:
    """Return where single samples stand far beyond their neighbours and all others."""
    wheels = run.wheels
    if wheels is None or len(wheels) < _FEWEST:
        return []
    found = np.zeros(len(wheels), bool)
    for values in (wheels.v, wheels.omega):
        beside = np.maximum(np.abs(values[:-2]), np.abs(values[2:]))
        usual = float(np.quantile(np.abs(values), _USUAL))
        found[1:-1] |= np.abs(values[1:-1]) > np.maximum(_FAR * beside, _FAR * max(usual, _LEAST))
    return [run.place(t) for t in wheels.t[found].tolist()]

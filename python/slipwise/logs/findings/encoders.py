# SPDX-License-Identifier: Apache-2.0
"""Finds what encoders do wrong: samples that jump, as a counter does that wraps or is reset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Log, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_FEWEST = 100  # samples, before a spike among them is told
_USUAL = 0.8  # quantile of sizes that are no spikes
_FAR = 6.0  # times the usual size, and the neighbours'
_LEAST = 0.02  # m/s or rad/s, below which speeds are those of a robot that stands
_CURE = "Unwrap the counter (16 bits, pi, 2 pi) in the driver, or publish velocities."
_TURNS = 4  # changes of direction, before jumps at them are said
_SAID, _RARE = 0.6, 0.02  # of them have one, and of all other samples so few
_JUMP = 0.03  # m/s beyond both neighbours; and of the usual size,
_OF_USUAL = 0.05
_MOVES = 0.02  # m/s
_AT_REST = 1.0  # s in which a robot turns round
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


class ReversalJumps(Check):
    """Ticks that jump where the wheels change their direction."""

    kind, family, spoils = "reversal-jumps", "encoders", False
    means = "ticks jump when the wheels change direction: a quadrature channel, the sign of a count, slack"
    shows = "at 60 % of 4 changes and more one speed lies beyond both neighbours, and hardly ever elsewhere"
    cure = "wiring of the encoder's channels A and B, its decoder; the sign of the counts in the driver"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare samples beside changes of direction with all others."""
        parts = [_beyond(run) for run in whole.log.runs]
        at, beside = (np.concatenate([np.empty(0), *column]) for column in zip(*parts, strict=True))
        jumps = float(np.median(at[at > 0.0])) if (at > 0.0).any() else 0.0
        if len(at) < _TURNS or np.mean(at > 0.0) < _SAID or np.mean(beside > 0.0) > _RARE:
            return None
        return self.found(
            f"at {int((at > 0.0).sum())} of {len(at)} changes of direction one speed of the wheels jumps, by "
            f"{jumps:.2g} m/s as a rule, and hardly ever elsewhere: ticks are counted wrong there",
            "Look at the wiring of the encoder's channels, its decoder, and the sign of the counts.",
            evidence=jumps,
        )


def _beyond(run: Run) -> tuple[Floats, Floats]:
    """Return by how much speeds lie clearly beyond both neighbours, at changes of direction and elsewhere."""
    wheels = run.wheels
    if wheels is None or len(wheels) < _FEWEST:
        return np.empty(0), np.empty(0)
    v = wheels.v
    before, now, after = v[:-2], v[1:-1], v[2:]
    low, high = np.minimum(before, after), np.maximum(before, after)
    usual = float(np.quantile(np.abs(v), _USUAL))
    beyond = np.zeros(len(v))
    beyond[1:-1] = np.maximum(now - high, low - now)
    beyond[beyond < max(_JUMP, _OF_USUAL * usual)] = 0.0
    level = v.copy()
    level[1:-1] = np.median(np.stack((before, now, after)), axis=0)
    moves = np.flatnonzero(np.abs(level) > _MOVES)
    turn = np.sign(level[moves[1:]]) != np.sign(level[moves[:-1]])
    turn &= np.diff(wheels.t[moves]) < _AT_REST
    spans = [slice(max(a - 1, 0), b + 2) for a, b in zip(moves[:-1][turn], moves[1:][turn], strict=True)]
    others = np.ones(len(v), bool)
    for span in spans:
        others[span] = False
    return np.array([beyond[span].max() for span in spans]), beyond[others]


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

# SPDX-License-Identifier: Apache-2.0
"""Finds what encoders do wrong: samples that jump, as a counter does that wraps or is reset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.logs.findings.finding import Check, Finding

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_LEFT = "absurd-speed"  # kind of what a reader leaves out


class WheelSpikes(Check):
    """Single speeds of wheels that no robot can have."""

    kind, family, spoils = "wheel-spikes", "encoders", False
    means = "a counter wraps (16 bits, pi, 2 pi) or is reset, or ticks jump: speeds far beyond all others"
    shows = "samples more than 15 times as fast as all before, alone among their neighbours"
    cure = "none: they are left out; unwrap the counter in the driver"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at what was left out of the wheels."""
        left = [e for e in whole.log.left_out if e.kind == _LEFT and e.reason.startswith("wheels")]
        if not left:
            return None
        count = sum(each.count for each in left)
        return self.found(
            f"{count} wheel speeds jump far beyond all others for one sample (first at {left[0].where}): a "
            "counter wraps or is reset",
            "They are left out. Unwrap the counter (16 bits, pi, 2 pi) in the driver, or publish velocities.",
            evidence=count,
        )

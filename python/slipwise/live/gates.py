# SPDX-License-Identifier: Apache-2.0
"""When nothing may be learned: an operator drives, the drive is at its limit, in reverse, on stale input."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.live.samples import Command, Override, Pose, Stamped, Twist, Wheels
from slipwise.logs.findings.sources import TwoSources, pose_watch, twist_watch
from slipwise.models import Model

RECOVERY = 2.0  # s for which a gate stays closed after its cause: lag and delay reach that far
REVERSE = -0.05  # m/s; slower than this is no driving in reverse
STALE_AFTER = 1.0  # s without input: drives that miss commands for so long have stopped


@dataclass(frozen=True)
class GateRules:
    """What closes the gates."""

    stale_after: float = STALE_AFTER  # s without input
    reverse: bool = True  # whether driving in reverse is learned
    saturation: tuple[float, float] = (math.inf, math.inf)  # |v| [m/s] and |omega| [rad/s] the drive reaches


def rules_for(start: Model | None) -> GateRules:
    """Return the rules for a start model, if any: one that never drove in reverse is not taught it."""
    reverse = start is None or start.content.range.speed[0] < REVERSE
    top = (math.inf, math.inf)
    if start is not None:
        found = start.parameters
        names = ("limits.speed.saturation", "limits.yaw_rate.saturation")
        top = tuple(  # type: ignore[assignment]
            found[name].value if name in found and found[name].identified else math.inf for name in names
        )
    return GateRules(STALE_AFTER, reverse, top)


class Gates:
    """Follows the samples, and says why nothing may be learned."""

    def __init__(self, rules: GateRules, *, input_name: str) -> None:
        self._rules, self._input = rules, Command if input_name == "command" else Wheels
        self._until: dict[str, float] = {}  # s, of each cause
        self.frozen = False  # on request
        self._override = False
        self._last_input = -math.inf
        self._wheels, self._poses = twist_watch(), pose_watch()

    def take(self, sample: Stamped) -> None:
        """Take a sample in the order in which it came; one without a stamp says nothing."""
        if not math.isfinite(sample.t):
            return
        if isinstance(sample, Override):
            self._take_override(sample)
        elif isinstance(sample, Pose):
            if not sample.source and self._poses.take(sample.t, (sample.x, sample.y)):
                self._close(TwoSources.on("pose").sentence, sample.t, 0.0)
        elif isinstance(sample, Command | Wheels):
            self._take_twist(sample)

    def why(self, t: float) -> str:
        """Return why nothing is learned at a stamp [s]; empty where it is."""
        if self.frozen:
            return "it was asked to rest"
        if self._override:
            return "an operator drives"
        for cause, until in self._until.items():
            if t < until:
                return cause
        return ""

    def waits(self, t: float) -> str:
        """Return what the learner lacks at a stamp [s]; it leaves such stretches out itself."""
        if not math.isfinite(self._last_input):
            return "no input yet"
        if t > self._last_input + self._rules.stale_after:
            return f"the input is stale by {t - self._last_input:.1f} s"
        return ""

    def restart(self) -> None:
        """The clock was set: times of before say nothing."""
        self._until.clear()
        self._last_input = -math.inf

    def _take_override(self, sample: Override) -> None:
        if self._override and not sample.active:
            self._close("an operator drove a moment ago", sample.t, RECOVERY)
        self._override = sample.active

    def _take_twist(self, sample: Twist) -> None:
        t, rules = sample.t, self._rules
        if isinstance(sample, Wheels) and self._wheels.take(t, (sample.v, sample.vy, sample.omega)):
            self._close(TwoSources.on("wheel").sentence, t, 0.0)
        if not isinstance(sample, self._input):
            return
        self._last_input = max(self._last_input, t)
        if not rules.reverse and sample.v < REVERSE:
            self._close("driving in reverse, which the model never learned", t, RECOVERY)
        top_v, top_omega = rules.saturation
        if abs(sample.v) > top_v or abs(sample.omega) > top_omega:
            self._close("the command is beyond what the drive reaches", t, RECOVERY)

    def _close(self, cause: str, t: float, seconds: float) -> None:
        self._until[cause] = max(self._until.get(cause, -math.inf), t + seconds + 1e-3)

# SPDX-License-Identifier: Apache-2.0
"""Finds poses whose clock steps, drifts or runs at another rate than that of the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.pose_streams import inputs_of, told_by
from slipwise.logs.findings.seen import WORDS, WholeLog
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Floats, Inputs, Run
from slipwise.logs.pose_clock import Driven, agreements_of, pose_motion
from slipwise.logs.running_offset import RunningOffset, running_offsets
from slipwise.number_text import estimate_text

_SHORTEST = 90.0  # s of a run; before and after a step there are four windows each at least,
_FEWEST, _MOST = 4, 12  # and as many are compared
_STEP, _STEP_ALONE = 0.1, 0.2  # s that speeds and turns show, and that one of them shows alone
_ALIKE = 0.5  # of a step, which each of them shows at least
_MOVED = 0.2  # s by which a drift moves a clock over a run, at least
_STEP_CERTAIN, _DRIFT_CERTAIN = 6.5, 8.0  # standard deviations; real logs have 5 and 6
_LEAST_STD = 0.015  # s of an offset
_WITHIN = 5.0  # s beyond the middles of two windows, a step may be that lies between them
_OVERLAP = 2.0  # times the variance, since windows overlap by half

_BEGIN = 100.0  # s in which rates are compared
_KNOWN = 40.0  # s of them in which inputs are known, at least
_RATE_OFF = 0.02  # a rate so far from 1 is told by 100 s
_RATES, _RATE = 0.4, 0.005  # rates are tried as far from 1, in such steps
_OFFSETS = np.arange(-3.0, 3.05, 0.1)  # s
_NONE = np.zeros(1)
_FIT, _BETTER = 0.7, 0.15  # least agreement at another rate, and by how much it beats none


@dataclass(frozen=True)
class _Moved:
    """How the clock of the poses moves in a run, against that of the inputs."""

    seconds: float  # by which the stamps of the poses are later after it
    size: float  # s of a step, s/s of a drift
    std: float  # of the size
    left: float  # s that windows are off it, in the mean
    at: float = np.nan  # s, of a step,
    within: float = np.nan  # s of which it is


class ClockDrift(Check):
    """Poses whose clock does not go with that of the inputs."""

    kind, family = "clock-drift", "clocks"
    means = "the clocks of poses and inputs step or drift apart, or one is simulated time at another rate"
    shows = (
        "windows of 20 s agree best with poses 0.1 s off from one time on, or more and more; "
        "or the first 100 s at another rate"
    )
    cure = "one clock (chrony, PTP, `use_sim_time`); `--start`, `--end` keep one side of a step"
    hidden_by = ("two-sources", "wheel-spikes", "unreachable-poses")

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Try rates of the poses' time, then follow the offset of clocks through each run."""
        name = told_by(whole)
        both = [(run, inputs) for run in whole.log.runs if (inputs := inputs_of(run, name)) is not None]
        if not both:
            return None
        longest = max(both, key=lambda each: len(each[0].poses))
        return self._other_rate(*longest, name, whole.unknown_after) or self._moving(both, name, whole)

    def _moving(self, both: Sequence[tuple[Run, Inputs]], name: str, whole: WholeLog) -> Finding | None:
        """Say where the clocks step or drift apart most."""
        found = [
            (moved, run)
            for run, inputs in both
            if (moved := _moves(run, inputs, whole.unknown_after, lagging=name == "command")) is not None
        ]
        if not found:
            return None
        moved, run = max(found, key=lambda each: abs(each[0].seconds))
        inputs, late = WORDS[name].name, "later" if moved.size > 0.0 else "sooner"
        side = "ahead of" if moved.size > 0.0 else "behind"
        if np.isnan(moved.at):
            size = estimate_text(1e3 * abs(moved.size), 1e3 * moved.std)
            drive = f", or the drive answers {late} and {late}" if name == "command" else ""
            return self.found(
                f"the poses' clock drifts {side} that of the {inputs} "
                f"by {size} ms a second, {abs(moved.seconds):.2f} s over run {run.name}{drive}",
                "Date both by one clock (chrony, PTP; use_sim_time in a simulation): no one offset mends it.",
                evidence=moved.size,
            )
        size = estimate_text(abs(moved.size), moved.std)
        drive = f", or the drive answers {late} since" if name == "command" else ""
        return self.found(
            f"the poses' clock steps {'forward' if moved.size > 0.0 else 'back'} by {size} s against that of "
            f"the {inputs}, within {moved.within:.0f} s of {run.place(moved.at)}{drive}",
            "Let the clocks settle before recording (chronyc waitsync), and date both by one clock.",
            "--start and --end leave out what is before or after it.",
            evidence=moved.size,
        )

    def _other_rate(self, run: Run, inputs: Inputs, name: str, unknown_after: float) -> Finding | None:
        """Try rates of the poses' time about their first stamp, where no offset makes both agree."""
        p = run.poses
        held = HeldSum.of(inputs, inputs.v, unknown_after)
        if len(p) < 3 or float(held.known(p.t[:1], p.t[:1] + _BEGIN)[0]) < _KNOWN:
            return None
        begin = p.t < p.t[0] + _BEGIN
        heading = np.full(len(p), np.nan) if p.course else p.yaw
        drive = [Driven.of(inputs, 0.0, unknown_after)]

        def fit(rate: float, offsets: Floats) -> float:
            t = p.t[0] + (p.t[begin] - p.t[0]) / rate
            motion = pose_motion(t, p.x[begin], p.y[begin], heading[begin])
            return float(agreements_of(drive, motion, offsets).max())

        none = fit(1.0, _OFFSETS)
        if none > _FIT:
            return None
        rates = 1.0 + np.arange(-_RATES, _RATES + 0.5 * _RATE, _RATE)
        fits = [fit(rate, _NONE) for rate in rates.tolist()]
        best = int(np.argmax(fits))
        if abs(rates[best] - 1.0) < _RATE_OFF or fits[best] < max(_FIT, none + _BETTER):
            return None
        at_rate = replace(p, t=p.t[0] + (p.t - p.t[0]) / rates[best])
        lagging = name == "command"
        if max(map(len, running_offsets(inputs, at_rate, unknown_after, lagging=lagging))) < _FEWEST:
            return None  # too little of the drive tells it from chance
        return self.found(
            f"the poses' time runs at {rates[best]:.3g} of that of the {WORDS[name].name}: so they agree "
            f"({fits[best]:.2f}), and at the same rate they do not ({none:.2f})",
            "Where this is a simulation, set use_sim_time for every node; else date both by one clock.",
            evidence=float(rates[best]) - 1.0,
        )


def _moves(run: Run, inputs: Inputs, unknown_after: float, *, lagging: bool) -> _Moved | None:
    """Return the step or the drift of a run, whichever explains its windows better."""
    if len(run.poses) < 2 or run.poses.t[-1] - run.poses.t[0] < _SHORTEST:
        return None
    both = running_offsets(inputs, run.poses, unknown_after, lagging=lagging)
    found = [each for each in (_step(both), _drift(both)) if each is not None]
    return min(found, key=lambda each: each.left, default=None)


def _step(both: Sequence[RunningOffset]) -> _Moved | None:
    """Return the most certain step; where speeds and turns both tell of it, they must agree."""
    times = np.unique(np.concatenate([each.t for each in both]))
    best: _Moved | None = None
    for before, after in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        steps = [step for each in both if (step := _step_at(each, before)) is not None]
        if not steps:
            continue
        size, std = _mean(steps)
        certain = abs(size) > max(_STEP_CERTAIN * std, _STEP if len(steps) > 1 else _STEP_ALONE)
        alike = all(step * np.sign(size) > _ALIKE * abs(size) for step, _ in steps)
        if certain and alike and (best is None or abs(size) * best.std > abs(best.size) * std):
            left = _left([each.offset - size * (each.t > before) for each in both])
            best = _Moved(-size, -size, std, left, 0.5 * (before + after), 0.5 * (after - before) + _WITHIN)
    return best


def _step_at(offsets: RunningOffset, time: float) -> tuple[float, float] | None:
    """Return by how much offsets are larger after a time than before, and its standard deviation [s]."""
    middle = int(np.searchsorted(offsets.t, time, side="right"))
    parts = offsets.offset[max(middle - _MOST, 0) : middle], offsets.offset[middle : middle + _MOST]
    if min(map(len, parts)) < _FEWEST:
        return None
    before, after = (float(np.median(part)) for part in parts)
    rest = np.concatenate((parts[0] - before, parts[1] - after))
    std = _scatter(rest, offsets)
    return after - before, std * float(np.sqrt(_OVERLAP * sum(1.0 / len(part) for part in parts)))


def _drift(both: Sequence[RunningOffset]) -> _Moved | None:
    """Return the drift of all windows of a run."""
    pairs = [_slopes(each) for each in both if len(each) >= 2 * _FEWEST]
    if not pairs:
        return None
    slope, information = float(np.median(np.concatenate(pairs))), 0.0
    for each in both:
        if len(each) >= 2 * _FEWEST:
            rest = each.offset - slope * each.t
            scatter = _scatter(rest - np.median(rest), each)
            information += float(((each.t - each.t.mean()) ** 2).sum()) / (_OVERLAP * scatter**2)
    times = np.concatenate([each.t for each in both])
    moved, std = slope * float(np.ptp(times)), float(1.0 / np.sqrt(information))
    if abs(moved) < _MOVED or abs(slope) < _DRIFT_CERTAIN * std:
        return None
    return _Moved(-moved, -slope, std, _left([each.offset - slope * each.t for each in both]))


def _slopes(offsets: RunningOffset) -> Floats:
    """Return slopes between windows that are half of all windows apart."""
    half = len(offsets) // 2
    first, last = slice(0, len(offsets) - half), slice(half, None)
    return np.asarray((offsets.offset[last] - offsets.offset[first]) / (offsets.t[last] - offsets.t[first]))


def _scatter(rest: Floats, offsets: RunningOffset) -> float:
    """Return the standard deviation of an offset [s] from what is left of some [N] beside two medians."""
    left = 1.48 * float(np.median(np.abs(rest))) * len(rest) / (len(rest) - 2)
    return max(left, float(np.median(offsets.std)), _LEAST_STD)


def _mean(sizes: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the weighted mean of sizes and its standard deviation."""
    weights = np.array([std**-2.0 for _, std in sizes])
    mean = float(weights @ [size for size, _ in sizes] / weights.sum())
    return mean, float(weights.sum() ** -0.5)


def _left(rest: Sequence[Floats]) -> float:
    """Return how far offsets of speeds and of turns are from the median of each, in the mean [s]."""
    each = [np.abs(part - np.median(part)) for part in rest if len(part)]
    return float(np.concatenate(each).mean())

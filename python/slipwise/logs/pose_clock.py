# SPDX-License-Identifier: Apache-2.0
"""Finds the offset between the clock of poses and that of inputs from the motion that both saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.errors import LogError
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Floats, Inputs
from slipwise.logs.motion_windows import wrapped

_COARSE = 0.1  # [s] grid of the search over all offsets
_MIDDLE = 0.05  # [s] grid around the best of these
_FINE = 0.01  # [s] grid around the best of these again
_KNOWN = 0.9  # of a time, inputs must be known
_REACH = 1.2  # [s] of the fine search to either side; a drive's lag moves the coarse peak by less
_LEAST_STEP = 0.3  # [s] between the poses that speeds are taken from; less is mostly their noise
_LONGEST_STEP = 1.5  # [s] beyond this the speed between two poses says little
_LEAST_OVERLAP = 20.0  # [s] of driving that both must have seen,
_LEAST_PART = 0.5  # and of the shorter recording
_GOOD = 0.5  # least agreement; below it these are different drives
_APART = 0.1  # by which the best offset must beat the next peak
_LOBE = 1.0  # [s] around the best that belong to its peak
_LITTLE = 0.05  # of the usual variance; an overlap with less motion than that is not compared
_DAY = 86_400.0  # [s]
_LONGEST = 4.0 * _DAY  # that is searched for an offset
_LAGS = (0.0, 0.1, 0.2, 0.4, 0.8)  # [s] of drives that follow commands


@dataclass(frozen=True)
class ClockMatch:
    """The offset that was found."""

    offset: float  # [s] to add to the stamps of the poses
    agreement: float  # mean correlation of speeds and yaw rates, 1 at best
    next_best: float  # that of the best other offset


@dataclass(frozen=True, eq=False)
class PoseMotion:
    """Unsigned speeds and yaw rates between poses that follow each other, [N] each."""

    start: Floats  # [s] on the clock of the poses
    stop: Floats
    speed: Floats  # [m/s]
    rate: Floats  # [rad/s], NaN where there is no heading


def pose_motion(t: Floats, x: Floats, y: Floats, yaw: Floats) -> PoseMotion:
    """Return the motion between poses [M] that are 0.3 s apart or more; their stamps must increase."""
    slot = np.floor((t - t[:1] + _core.SAME_STAMP) / _LEAST_STEP)
    kept = np.flatnonzero(np.diff(slot, prepend=-1.0) > 0.0)
    i, j = kept[:-1], kept[1:]
    step = t[j] - t[i]
    near = (step > 0.5 * _LEAST_STEP + _core.SAME_STAMP) & (step < _LONGEST_STEP - _core.SAME_STAMP)
    i, j, step = i[near], j[near], step[near]
    speed = np.hypot(x[j] - x[i], y[j] - y[i]) / step
    return PoseMotion(t[i], t[j], _clipped(speed), _clipped(wrapped(yaw[j] - yaw[i]) / step))


def find_clock_offset(
    inputs: Sequence[Inputs], motion: PoseMotion, unknown_after: float, *, lagging: bool
) -> ClockMatch:
    """Find the offset at which speeds and yaw rates agree best: over all offsets, then finely around it.

    Args:
        inputs: of all runs, on one clock.
        motion: of the poses.
        unknown_after: an input is unknown once it is older than this [s].
        lagging: the inputs are commands, which a drive follows with a lag; its delay stays in the offset.

    Raises:
        LogError: the two saw too little of the same drive, or several offsets fit.
    """
    inputs = [_near(part) for part in inputs]
    usual = np.abs(motion.start - np.median(motion.start)) < _DAY
    motion = PoseMotion(*(column[usual] for column in (motion.start, motion.stop, motion.speed, motion.rate)))
    lags = _LAGS if lagging else _LAGS[:1]
    drives = [[Driven.of(part, lag, unknown_after) for part in inputs] for lag in lags]
    coarse = _coarse(drives[len(drives) // 2], motion)
    offsets = coarse.offset + np.arange(-_REACH, _REACH + _MIDDLE, _MIDDLE)
    scores = np.array([agreements_of(drive, motion, offsets) for drive in drives])
    drive, best = (int(place) for place in np.unravel_index(int(np.argmax(scores)), scores.shape))
    offsets = offsets[best] + np.arange(-_MIDDLE, _MIDDLE + 0.5 * _FINE, _FINE)
    fine = agreements_of(drives[drive], motion, offsets)
    best = int(np.argmax(fine))
    offset = float(offsets[best]) + _FINE * _vertex(fine, best)
    found = ClockMatch(offset, float(fine[best]), coarse.next_best)
    if found.agreement < _GOOD:
        raise _no_fit(found.agreement)
    if found.agreement - found.next_best < _APART:
        raise _ambiguous(f"{found.offset:.1f} s and others")
    return found


@dataclass(frozen=True, eq=False)
class Driven:
    """The inputs of one run, summed over time."""

    first: float  # [s]
    last: float
    given: HeldSum  # says when the inputs are known
    motion: HeldSum  # of speeds, and of yaw rates as imaginary parts: both are looked up at once

    @classmethod
    def of(cls, inputs: Inputs, lag: float, unknown_after: float) -> Driven:
        """Sum inputs, as a drive with a time constant of `lag` [s] follows them."""
        part, given = _lagged(inputs, lag), HeldSum.of(inputs, inputs.v, unknown_after)
        motion = HeldSum.of(part, np.hypot(part.v, part.vy) + 1j * part.omega, unknown_after)
        return cls(float(inputs.t[0]), float(inputs.t[-1]), given, motion)


def agreement_at(inputs: Sequence[Inputs], motion: PoseMotion, offset: float, unknown_after: float) -> float:
    """Return the agreement of speeds and yaw rates at an offset [s]; -1 where there is nothing to compare."""
    return float(agreements(inputs, motion, np.array([offset]), unknown_after)[0])


def agreements(inputs: Sequence[Inputs], motion: PoseMotion, offsets: Floats, unknown_after: float) -> Floats:
    """Return the agreement at each of some offsets [N] in s, as `agreement_at` does."""
    return agreements_of([Driven.of(part, 0.0, unknown_after) for part in inputs], motion, offsets)


def _coarse(drive: Sequence[Driven], motion: PoseMotion) -> ClockMatch:
    """Search all offsets by the normalised correlation of what both know (Padfield 2012, masked)."""
    begin, stop = min(part.first for part in drive), max(part.last for part in drive)
    if stop - begin > _LONGEST:
        what = f"the log spans {(stop - begin) / _DAY:.0f} days, too long to look for an offset of clocks"
        raise LogError(what, advice="give the seconds to add with --pose-clock-offset")
    grid: Floats = begin + _COARSE * np.arange(int((stop - begin) / _COARSE) + 1, dtype=np.float64)
    driven = input_means(drive, grid, grid + _COARSE)
    own = motion.start[0] + _COARSE * np.arange(int((motion.stop[-1] - motion.start[0]) / _COARSE) + 1)
    at = np.clip(np.searchsorted(motion.start, own, side="right") - 1, 0, None)
    inside = own < motion.stop[at]
    seen = [np.where(inside, values[at], np.nan) for values in (motion.speed, motion.rate)]
    score, lags = _correlate(seen, driven)
    offsets = begin - motion.start[0] + _COARSE * lags
    best = int(np.argmax(score))
    peaks = np.flatnonzero((score[1:-1] >= score[:-2]) & (score[1:-1] >= score[2:])) + 1
    others = peaks[np.abs(offsets[peaks] - offsets[best]) > _LOBE]
    second = int(others[np.argmax(score[others])]) if len(others) else best
    next_best = float(score[second]) if second != best else 0.0
    if score[best] <= -1.0:
        raise LogError(
            f"poses and log have less than {_LEAST_OVERLAP:g} s of changing motion to compare",
            advice="give the seconds to add with --pose-clock-offset",
        )
    if score[best] < _GOOD:
        raise _no_fit(float(score[best]))
    if score[best] - next_best < _APART:
        raise _ambiguous(f"{offsets[best]:.1f} s and {offsets[second]:.1f} s")
    return ClockMatch(float(offsets[best]), float(score[best]), next_best)


def _no_fit(agreement: float) -> LogError:
    return LogError(
        "the motion of the poses does not fit the log's at any offset of clocks"
        f" (best agreement {max(agreement, 0.0):.2f})",
        advice="check that both are of one drive; else give the seconds to add with --pose-clock-offset",
    )


def _ambiguous(offsets: str) -> LogError:
    return LogError(
        f"several offsets of clocks fit equally: {offsets}",
        advice="give the seconds to add with --pose-clock-offset, or record turns that do not repeat",
    )


def _correlate(seen: Sequence[Floats], driven: Sequence[Floats]) -> tuple[Floats, Floats]:
    """Return the mean correlation over channels at each lag [L], and the lags [L] in steps of the grid.

    Where only a part of the shorter recording overlaps, chance fits better; its correlation counts for less.
    """
    m, n = len(seen[0]), len(driven[0])
    size = 1 << (m + n).bit_length()
    lags = np.arange(-(m - 1), n, dtype=np.float64)
    total, count = np.zeros(len(lags)), np.zeros(len(lags))

    def sums(a: Floats, b: Floats) -> Floats:
        """Sum a[k] b[k + lag] over k, for all lags."""
        spectrum = np.conj(np.fft.rfft(a, size)) * np.fft.rfft(b, size)
        wrapped_sums = np.fft.irfft(spectrum, size)
        return np.concatenate([wrapped_sums[size - (m - 1) :], wrapped_sums[:n]])

    for f, g in zip(seen, driven, strict=True):
        known_f, known_g = np.isfinite(f).astype(float), np.isfinite(g).astype(float)
        f, g = np.nan_to_num(f), np.nan_to_num(g)
        both = np.round(sums(known_f, known_g))
        least = max(_LEAST_OVERLAP / _COARSE, _LEAST_PART * min(known_f.sum(), known_g.sum()))
        enough = both >= least
        each = np.where(enough, both, 1.0)
        mean_f, mean_g = sums(f, known_g) / each, sums(known_f, g) / each
        var_f = sums(f * f, known_g) / each - mean_f**2
        var_g = sums(known_f, g * g) / each - mean_g**2
        moved = enough & (var_f > _LITTLE * f.var()) & (var_g > _LITTLE * g.var())
        moved &= (var_f > 0.0) & (var_g > 0.0)
        product = np.where(moved, var_f * var_g, 1.0)
        correlation = (sums(f, g) / each - mean_f * mean_g) / np.sqrt(product)
        total += np.where(moved, correlation * np.sqrt(both / max(float(both.max()), 1.0)), 0.0)
        count += moved
    return np.where(count > 0, total / np.maximum(count, 1.0), -1.0), lags


def agreements_of(drive: Sequence[Driven], motion: PoseMotion, offsets: Floats) -> Floats:
    """Return what `agreements` does of inputs that were summed before."""
    scores = np.empty(len(offsets))
    for k, offset in enumerate(offsets.tolist()):
        driven = input_means(drive, motion.start + offset, motion.stop + offset)
        found = [_correlation(f, g) for f, g in zip((motion.speed, motion.rate), driven, strict=True)]
        known = [value for value in found if np.isfinite(value)]
        scores[k] = float(np.mean(known)) if known else -1.0
    return scores


def input_means(drive: Sequence[Driven], start: Floats, stop: Floats) -> tuple[Floats, Floats]:
    """Return the mean speed and yaw rate of the drive between stamps, NaN where it is unknown.

    Args:
        drive: the inputs of each run.
        start: of each stretch [N] in s.
        stop: its end [N] in s.
    """
    speed, rate = np.full(len(start), np.nan), np.full(len(start), np.nan)
    for part in drive:
        known = part.given.known(start, stop) > _KNOWN * (stop - start) + _core.SAME_STAMP
        moved, seconds = part.motion.between(start[known], stop[known]), (stop - start)[known]
        speed[known], rate[known] = moved.real / seconds, moved.imag / seconds
    return speed, rate


def _near(inputs: Inputs) -> Inputs:
    """Leave out inputs with a stray stamp, more than a day from the others."""
    near = np.abs(inputs.t - np.median(inputs.t)) < _DAY
    return inputs.select(near)


def _lagged(inputs: Inputs, lag: float) -> Inputs:
    """Return inputs as a drive with a time constant of `lag` [s] follows them, on a fine grid."""
    if lag == 0.0 or len(inputs) < 2:
        return inputs
    t = np.arange(float(inputs.t[0]), float(inputs.t[-1]), 2.0 * _FINE)
    kernel = np.exp(-np.arange(0.0, 6.0 * lag, 2.0 * _FINE) / lag)
    held = np.clip(np.searchsorted(inputs.t, t, side="right") - 1, 0, None)
    v, vy, omega = (
        np.convolve(column[held], kernel / kernel.sum())[: len(t)]
        for column in (inputs.v, inputs.vy, inputs.omega)
    )
    return Inputs(t, v, vy, omega)


def _correlation(f: Floats, g: Floats) -> float:
    both = np.isfinite(f) & np.isfinite(g)
    if both.sum() < 3:
        return float("nan")
    a, b = f[both] - f[both].mean(), g[both] - g[both].mean()
    scale = float(np.sqrt((a * a).sum() * (b * b).sum()))
    return float((a * b).sum()) / scale if scale > 1e-9 else float("nan")


def _vertex(score: Floats, best: int) -> float:
    """Return where between grid points the parabola through the peak has its top, in steps."""
    if not 0 < best < len(score) - 1:
        return 0.0
    left, middle, right = score[best - 1 : best + 2].tolist()
    bend = left - 2.0 * middle + right
    return 0.5 * (left - right) / bend if bend < 0.0 else 0.0


def _clipped(values: Floats) -> Floats:
    """Limit outliers, such as jumps of a localiser, to three times what nearly all values stay within."""
    if not np.isfinite(values).any():
        return values
    limit = 3.0 * float(np.nanpercentile(np.abs(values), 90.0))
    return np.clip(values, -limit, limit)

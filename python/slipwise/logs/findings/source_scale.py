# SPDX-License-Identifier: Apache-2.0
"""Finds two sources of poses of one drive whose tracks differ in size, as of a map that is too large.

In windows of twenty seconds, or ten of a short drive, the track of the further source is laid on that of
the first by the similarity that fits best, whatever frame it is in. Where it sits on the robot and how late
it is are free, so that neither passes for a scale; on a circle, where an arm cannot be told from a scale,
nothing is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Poses, Run
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

Complex = NDArray[np.complex128]

_WINDOWS = (20.0, 10.0)  # s; the shorter ones where there are few of the others
_STEP = 0.5  # s between what is compared in it
_SEEN_PART, _FEWEST_WINDOWS = 0.5, 4  # of a window, that both see; such windows
_LONGEST_STEP = 1.0  # s between poses of a source, on a straight line between which it is taken to be
_LEAST_WAY = 0.3  # m that positions scatter in a window beyond what arm and lateness explain,
_BEYOND_NOISE = 5.0  # and so many times what the best similarity leaves
_APART, _CERTAIN = 0.02, 6.0  # logarithm of the scale, and its standard deviations, from where on it is one
_LEAST_STD = 0.002  # of a window
_LASTS = 1.0  # s that noise of a source may last


@dataclass(frozen=True)
class _Fit:
    """What one window says."""

    scale: float  # logarithm of how many times the further track is as large
    std: float
    bias: float  # that noise of one source alone could make
    way: float  # m by the first source


class SourceScale(Check):
    """Sources of poses that do not agree how far the robot drives."""

    kind, family = "source-scale", "poses"
    means = "two sources of poses differ in size: a map that was built too large, another unit, other wheels"
    shows = "over 20 s the best similarity between their tracks scales by 2 % and more, by 6 deviations"
    cure = "name the one that is right: `--pose-topic` or `--poses` once, rows of one name in `source`"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare each further source with the first."""
        runs = whole.log.runs
        names = dict.fromkeys(name for run in runs for name in run.others)
        found = [each for name in names if (each := self._beside(name, runs)) is not None]
        return max(found, key=lambda each: abs(np.log(each.evidence or 1.0)), default=None)

    def _beside(self, name: str, runs: Sequence[Run]) -> Finding | None:
        both = [(run.poses, run.others[name]) for run in runs if name in run.others]
        for window in _WINDOWS:
            fits = [fit for pair in both for fit in _fits(*pair, window)]
            if len(fits) >= _FEWEST_WINDOWS:
                break
        else:
            return None
        scale, std, bias = _together(fits)
        if abs(scale) <= max(_APART, _CERTAIN * std) + bias:
            return None
        first = next((run.source for run in runs if run.source), "") or "the first source"
        ratio, way = float(np.exp(scale)), sum(fit.way for fit in fits)
        return self.found(
            f"the track of {name} is {estimate_text(ratio, ratio * std)} times as large as that of {first}, "
            f"over {way:.0f} m: they cannot both be right, and what is learned lies in between",
            "Measure which of them is right, and name it alone: --pose-topic or --poses once, or in a table "
            "only its rows.",
            evidence=ratio,
        )


def _together(fits: Sequence[_Fit]) -> tuple[float, float, float]:
    """Return the weighted median of scales, its deviation as windows scatter, and the mean bias."""
    scale, std, bias = (np.array([getattr(fit, name) for fit in fits]) for name in ("scale", "std", "bias"))
    weight = std**-2.0
    order = np.argsort(scale)
    middle = int(np.searchsorted(np.cumsum(weight[order]), 0.5 * weight.sum()))
    median = float(scale[order][middle])
    factor = max(1.0, 1.48 * float(np.median(np.abs(scale - median) / std)))
    factor *= 1.0 + 4.0 / len(fits)  # few may be alike by chance
    return median, 1.25 * factor * float(weight.sum()) ** -0.5, float(weight @ bias / weight.sum())


def _fits(first: Poses, other: Poses, window: float) -> Iterator[_Fit]:
    """Yield what each window [s] says that both see, in one frame each."""
    if min(len(first), len(other)) < 2:
        return
    begin, stop = max(first.t[0], other.t[0]) + _STEP, min(first.t[-1], other.t[-1]) - _STEP
    yaw = np.unwrap(first.yaw)
    for start in np.arange(begin, stop - window, window).tolist():
        t = np.arange(start, start + window, _STEP)
        t = t[_seen(first, t) & _seen(other, t)]
        if len(t) < _SEEN_PART * window / _STEP:
            continue
        heading = np.exp(1j * np.interp(t, first.t, yaw))
        fit = _fit(_track(first, t), _track(other, t), heading)
        if fit is not None:
            yield fit


def _seen(poses: Poses, t: Floats) -> NDArray[np.bool_]:
    """Whether a source has poses about each time [N], in the frame that it has at the first one."""
    before = np.clip(np.searchsorted(poses.t, t - _STEP, side="right") - 1, 0, None)
    after = np.clip(np.searchsorted(poses.t, t + _STEP), None, len(poses) - 1)
    near = poses.t[after] - poses.t[before] < _LONGEST_STEP + 2.0 * _STEP
    frame = poses.frame[before[:1]]
    return np.asarray(near & (poses.frame[before] == frame) & (poses.frame[after] == frame))


def seen_at(poses: Poses, ends: Floats) -> bool:
    """Say whether a source has poses about some times in order, without a gap, and in one frame."""
    first, last = np.searchsorted(poses.t, (ends[0] - _STEP, ends[-1] + _STEP)).tolist()
    first, last = max(first - 1, 0), min(last, len(poses) - 1)
    t, frame = poses.t[first : last + 1], poses.frame[first : last + 1]
    return bool((np.diff(t) < _LONGEST_STEP + 2.0 * _STEP).all() and (frame == frame[0]).all())


def _track(poses: Poses, t: Floats) -> tuple[Complex, Complex]:
    """Return positions [N] in m and velocities [N] in m/s, as complex numbers."""

    def at(t: Floats) -> Complex:
        return np.interp(t, poses.t, poses.x) + 1j * np.interp(t, poses.t, poses.y)

    return at(t), (at(t + _STEP) - at(t - _STEP)) / (2.0 * _STEP)


def _fit(first: tuple[Complex, Complex], other: tuple[Complex, Complex], heading: Complex) -> _Fit | None:
    """Lay each track on the other; noise shrinks either scale, and their ratio by its difference alone."""
    there = _similarity(*first, other[0], heading)
    back = _similarity(*other, first[0], heading)
    if there is None or back is None:
        return None
    scale = 0.5 * (np.log(there[0]) - np.log(back[0]))
    noise = max(there[1], back[1])  # over the way that is compared
    way = float(np.abs(np.diff(first[0][:: round(2.0 / _STEP)])).sum())
    std = float(np.hypot(noise * np.sqrt(_LASTS / (_STEP * len(heading))), _LEAST_STD))
    return _Fit(float(scale), std, 0.5 * noise**2, way)


def _similarity(
    from_: Complex, velocity: Complex, to: Complex, heading: Complex
) -> tuple[float, float] | None:
    """Return the scale from one track [N] to another and what it leaves over the way; None if not clear."""
    free, _ = np.linalg.qr(np.column_stack((np.ones(len(from_)), heading, velocity)))
    way, target = (track - free @ (free.conj().T @ track) for track in (from_ - from_.mean(), to - to.mean()))
    size = float(np.sqrt(np.mean(np.abs(way) ** 2)))
    if size < _LEAST_WAY:
        return None
    factor = complex(np.vdot(way, target)) / float(np.vdot(way, way).real)
    noise = float(np.sqrt(np.mean(np.abs(target - factor * way) ** 2))) / size / max(abs(factor), 1e-9)
    return (abs(factor), noise) if noise * _BEYOND_NOISE < 1.0 else None

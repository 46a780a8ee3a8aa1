# SPDX-License-Identifier: Apache-2.0
"""Finds a gyro beside positions that turns further, or less far, than their track does.

In windows of 25 seconds the velocity of the track, seen along the heading that the gyro's rates add up to,
has to point ahead, wherever the antenna is. The gyro's scale, how late it is and the antenna's place ahead
are of all windows; the heading at first and the gyro's bias are free in each. Slip in turns is the robot's
own and no part of it: nothing is asked of wheels or commands.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.gyro import (
    COLUMN,
    Turned,
    gyro_rows,
    measured_rates,
    otherwise,
    turned_by,
    turns_otherwise,
)
from slipwise.logs.log import Floats, Poses, Run
from slipwise.logs.motion_windows import run_name
from slipwise.number_text import estimate_text, number_text

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen, WholeLog

_WINDOW, _STEP, _HALF = 25.0, 0.25, 0.5  # s; a velocity is that of a chord of twice _HALF
_AROUND = np.linspace(-_HALF, _HALF, 11)[:, None]  # s
_LONGEST_STEP = 1.0  # s between positions
_FEWEST_STEPS, _FEWEST_WINDOWS = 50, 4
_LEAST_WAY, _LEAST_TURN = 1.0, 0.5  # m and rad of a window
_LATEST = 1.0  # s that the gyro may be later than the positions, or earlier
_SCALES, _LATE = np.exp(0.1 * np.arange(-4, 5)), np.arange(-0.9, 1.0, 0.1)  # where the search begins,
_FAR = np.exp(0.1 * np.concatenate((np.arange(-26, -4), np.arange(5, 19))))  # and where nothing near fits
_FITS, _MISFITS = 0.01, 0.05  # of the squares of velocities, that the right scale leaves, and that none does,
_NEVER = 0.1  # and that no sliding does: of steep hills it is 0.04
_FEWER, _NOISY = 3, 2.0  # of the windows that near scales were tried in; times the noise that is explained
_SMALLEST, _LARGEST = 0.05, 7.0  # of the scale
_BIASES = np.linspace(-0.06, 0.06, 25)  # rad/s
_ROUGH, _ROUNDS = 10, 8  # windows by which the search begins, and its steps
_OUTLIER = 4.0  # times the usual error of a window, from which on it is left out
_WORST = 1e12  # condition, beyond which the drive tells nothing
_APART, _CERTAIN = 0.02, 4.0  # of the scale, and its standard deviations, from where on it is another
_WRONG = 1.5  # times as far, or as little
_LATER, _LATE_SPOILS = 0.1, 0.3  # s


class GyroScale(Check):
    """A gyro, learned from beside positions, whose turns are not those of their track."""

    kind, family, spoils, reserves = "gyro-scale", "signs and units", False, True
    means = "the gyro turns so many times as far as the track of the positions: its scale is wrong"
    shows = "over windows of 25 s the scale differs from 1 by 2 %, by 4 deviations; from 50 % on it spoils"
    cure = f"divide `{COLUMN}` by the number, or leave it out: positions tell turns too, less surely"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare the gyro with the track of each run."""
        found = gyro_scale(whole.log.runs)
        if found is not None and not found.fits:
            return self.found(
                "the turns of the gyro fit the track of the positions at no scale: slip of turns is wrong, "
                "or the robot slides to its sides",
                f"Look at {COLUMN}, its bias and its unit, or leave it out.",
                evidence=found.left_over,
                spoils=found.left_over > _NEVER or found.scale <= _FAR[0],  # as if it did not turn
            )
        if found is None or abs(found.scale - 1.0) <= max(_APART, _CERTAIN * found.std):
            return None
        return self.found(
            f"the gyro turns {estimate_text(found.scale, found.std)} times as far as the track of "
            f"the positions, over {found.windows} windows of {_WINDOW:g} s: slip of turns is wrong by it",
            f"Divide {COLUMN} by {number_text(found.scale)}, or leave it out: positions tell turns too, less "
            "surely.",
            evidence=found.scale,
            spoils=abs(math.log(found.scale)) > math.log(_WRONG),
        )


class GyroLate(Check):
    """A gyro, learned from beside positions, whose stamps are later than theirs."""

    kind, family, spoils, reserves = "gyro-late", "clocks", False, True
    means = "the gyro is stamped later than positions of the same motion: a queue, or another clock"
    shows = "windows of 25 s agree best with it 0.1 s later, by 4 deviations; from 0.3 s on it spoils"
    cure = f"stamp the gyro when it is measured, or leave `{COLUMN}` out"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare the gyro with the track of each run."""
        found = gyro_scale(whole.log.runs)
        if found is None or not found.fits or found.late <= max(_LATER, _CERTAIN * found.late_std):
            return None
        return self.found(
            f"the gyro is stamped {estimate_text(found.late, found.late_std)} s later than positions of the "
            "same motion: the delay of turning is wrong by it",
            f"Stamp the gyro when it is measured, or leave {COLUMN} out.",
            evidence=found.late,
            spoils=found.late > _LATE_SPOILS,
        )


@dataclass(frozen=True)
class TrackScale:
    """How many times as far as a track a gyro turns."""

    scale: float
    std: float
    late: float  # s that its stamps are later than those of the positions; of slip to a side, earlier
    late_std: float
    windows: int
    left_over: float  # of the squares of velocities, to a side at that scale

    @property
    def fits(self) -> bool:
        """Whether the track is one of a robot that turns so."""
        return self.left_over < _MISFITS


@dataclass(frozen=True, eq=False)
class _Window:
    t: Floats  # [N] s
    velocity: NDArray[np.complex128]  # [N] m/s
    gyro: Turned  # of all of the run

    def turns(self, late: float) -> tuple[Floats, Floats]:
        """Return how far it has turned about each time [11, N] and its yaw rate then [N]."""
        if late not in self._turns:
            turned = self.gyro.at(self.t + late + _AROUND)
            self._turns[late] = turned - turned.mean(), (turned[-1] - turned[0]) / (2.0 * _HALF)
        return self._turns[late]

    @property
    def squares(self) -> float:
        """The sum of the squares of velocities [m2/s2]."""
        return float(np.sum(np.abs(self.velocity) ** 2))

    @cached_property
    def noise(self) -> float:
        """What noise of the positions, as their roughness shows it, adds to the squares to one side."""
        rough = np.diff(self.velocity, 2)  # of six times the variance, where chords share no end
        return float(np.sum(np.abs(rough) ** 2)) / 12.0

    def begun(self, scale: float, late: float) -> tuple[float, float, float, float]:
        """Return the least sum of squares sideways, with the heading, the bias and the arm for it."""
        turned, rate = self.turns(late)
        along = np.exp(1j * turned / scale).mean(axis=0) * self._by_bias
        way = self.velocity * np.conj(along)
        columns = np.stack((way.real, way.imag, np.broadcast_to(-rate / scale, way.shape)), axis=-1)
        squares = np.einsum("bni,bnj->bij", columns, columns)
        by_arm = squares[:, 2, :2] / np.maximum(squares[:, 2, 2:], 1e-12)
        values, vectors = np.linalg.eigh(squares[:, :2, :2] - squares[:, :2, 2:] * by_arm[:, None, :])
        best = int(np.argmin(values[:, 0]))
        across = vectors[best, :, 0]
        heading = float(np.arctan2(-across[0], across[1]))
        if (way[best] * np.exp(-1j * heading)).real.sum() < 0.0:  # most of the way is driven forward
            heading, across = heading + np.pi, -across
        return float(values[best, 0]), heading, float(_BIASES[best]), -float(by_arm[best] @ across)

    def left(self, scale: float, late: float, arm: float) -> tuple[Floats, Floats]:
        """Return what is left sideways [N] and its derivatives by these [N, 3], heading and bias removed."""
        _, heading, bias, _ = self.begun(scale, late)
        either = [self._left((scale, late, arm), heading + by, bias) for by in (0.0, np.pi)]
        return min(either, key=lambda each: float(each[0] @ each[0]))

    def _left(self, state: tuple[float, float, float], heading: float, bias: float) -> tuple[Floats, Floats]:
        scale, late, arm = state
        turned, rate = self.turns(late)
        for _ in range(3):
            along = np.exp(1j * (turned / scale + heading + bias * self._since)).mean(axis=0)
            way = self.velocity * np.conj(along) / np.abs(along)
            rows = way.imag - arm * rate / scale
            own = np.column_stack((-way.real, -way.real * self._since))
            by_heading, by_bias = np.linalg.lstsq(own, rows, rcond=None)[0].tolist()
            heading, bias = heading - by_heading, bias - by_bias
        by_scale = (way.real * turned.mean(axis=0) + arm * rate) / scale**2
        by = np.column_stack((by_scale, -way.real * rate / scale, -rate / scale))
        q, _ = np.linalg.qr(own)
        return _without(q, rows), _without(q, by)

    @cached_property
    def _turns(self) -> dict[float, tuple[Floats, Floats]]:
        return {}  # by how late: each scale asks for them

    @cached_property
    def _by_bias(self) -> NDArray[np.complex128]:
        return np.asarray(np.exp(1j * _BIASES[:, None] * self._since))

    @cached_property
    def _since(self) -> Floats:
        return np.asarray(self.t - self.t.mean())


def _without(known: Floats, rows: Floats) -> Floats:
    return np.asarray(rows - known @ (known.T @ rows), dtype=np.float64)


def gyro_scale(runs: Iterable[Run]) -> TrackScale | None:
    """Return how far a gyro beside positions turns; None where too few windows say it."""
    return _track_scale(tuple(runs))


@lru_cache(maxsize=1)  # two checks ask
def _track_scale(runs: tuple[Run, ...]) -> TrackScale | None:
    windows = [window for run in runs for window in _windows(run)]
    if len(windows) < _FEWEST_WINDOWS:
        return None
    some = windows[:: max(1, len(windows) // _ROUGH)]
    scale, late = _begun(some)
    left_over = _left_over(some, (scale, late))
    if left_over > _MISFITS:
        return TrackScale(scale, math.nan, late, math.nan, len(windows), left_over)
    state = np.array((scale, late, np.median([each.begun(scale, late)[3] for each in windows])))
    std = np.full(2, np.nan)
    for _ in range(_ROUNDS):
        kept = _usual([window.left(*state.tolist()) for window in windows])
        information = sum((by.T @ by for _, by in kept), np.zeros((3, 3)))
        if not (np.isfinite(information).all() and np.linalg.cond(information) < _WORST):
            return None
        gradients = np.array([by.T @ rows for rows, by in kept])
        inverse = np.asarray(np.linalg.inv(information), dtype=np.float64)
        state = state - inverse @ gradients.sum(axis=0)
        if not (_SMALLEST < state[0] < _LARGEST and abs(state[1]) < _LATEST):
            return None
        std = _std(kept, inverse, gradients)
    if len(kept) < _FEWEST_WINDOWS:
        return None
    (scale, late, _), deviations = state.tolist(), std.tolist()
    left_over = _left_over(windows, (scale, late))
    return TrackScale(scale, deviations[0], late, deviations[1], len(kept), left_over)


def _begun(some: Sequence[_Window]) -> tuple[float, float]:
    """Return the scale, and how late, that fit best; far ones are tried where no near one fits."""
    best = _best(some, product(_SCALES.tolist(), _LATE.tolist()))
    if _left_over(some, best) < _FITS:
        return best
    return _best(some[::_FEWER], (best, *product(_FAR.tolist(), _LATE[::2].tolist())))


def _best(some: Sequence[_Window], tried: Iterable[tuple[float, float]]) -> tuple[float, float]:
    return min(tried, key=lambda at: sum(each.begun(*at)[0] for each in some))


def _left_over(some: Sequence[_Window], at: tuple[float, float]) -> float:
    """Return which part of the squares of velocities is sideways, and not by noise of the positions."""
    left, squares = sum(each.begun(*at)[0] for each in some), sum(each.squares for each in some)
    return max(left - _NOISY * sum(each.noise for each in some), 0.0) / max(squares, 1e-12)


def _usual(parts: Sequence[tuple[Floats, Floats]]) -> list[tuple[Floats, Floats]]:
    sizes = np.array([np.sqrt(np.mean(rows**2)) for rows, _ in parts])
    return [part for part, size in zip(parts, sizes, strict=True) if size <= _OUTLIER * np.median(sizes)]


def _std(kept: Sequence[tuple[Floats, Floats]], inverse: Floats, gradients: Floats) -> Floats:
    """Return the standard deviations of scale and lateness, as windows scatter or as their rows do."""
    count, free = len(kept), sum(len(rows) - 2 for rows, _ in kept) - 3
    rows = sum(float(rows @ rows) for rows, _ in kept) / free * 2.0 * _HALF / _STEP  # chords overlap
    scatter = np.diag(inverse @ gradients.T @ gradients @ inverse)[:2] * count / (count - 2)
    of_rows = np.diag(inverse)[:2] * rows
    return np.sqrt(np.maximum(scatter, of_rows)) * (1.0 + 4.0 / count)  # few may be alike by chance


def _windows(run: Run) -> Iterator[_Window]:
    poses, gyro = run.poses, turned_by(gyro_rows(run))
    if gyro is None or len(poses) < _FEWEST_STEPS or _drives_sideways(run):
        return
    for start in np.arange(poses.t[0] + _HALF, poses.t[-1] - _WINDOW - _HALF, _WINDOW).tolist():
        t = start + _STEP * np.arange(round(_WINDOW / _STEP))
        t = t[_seen(poses, t) & gyro.known(t, _LATEST + _HALF)]
        if len(t) < _FEWEST_STEPS:
            continue
        ends = [
            np.interp(t + by, poses.t, poses.x) + 1j * np.interp(t + by, poses.t, poses.y)
            for by in (-_HALF, _HALF)
        ]
        window = _Window(t, (ends[1] - ends[0]) / (2.0 * _HALF), gyro)
        way = _STEP * float(np.abs(window.velocity).sum())
        if way > _LEAST_WAY and np.ptp(gyro.at(t)) > _LEAST_TURN:
            yield window


def _drives_sideways(run: Run) -> bool:
    return any(given is not None and bool(given.vy.any()) for given in (run.commands, run.wheels))


def _seen(poses: Poses, t: Floats) -> NDArray[np.bool_]:
    """Whether positions are dense about each time [N], in the frame of the first one."""
    before = np.clip(np.searchsorted(poses.t, t - _HALF, side="right") - 1, 0, None)
    after = np.clip(np.searchsorted(poses.t, t + _HALF), None, len(poses) - 1)
    steps = np.append(0.0, np.cumsum(np.diff(poses.t) > _LONGEST_STEP))
    frame = poses.frame[before[:1]]
    same = (poses.frame[before] == frame) & (poses.frame[after] == frame)
    return np.asarray(same & (steps[before] == steps[after]))


class GyroTurnsOtherwise(Check):
    """A gyro, learned from or left out, that does not turn as the inputs do."""

    kind, family, reserves = "gyro-turns-otherwise", "signs and units", True
    means = "a gyro in degrees, clockwise, or with its z axis down"
    shows = "it turns less than 0.05 or more than 5 times as much as the inputs, over 15 s of turns"
    cure = f"`{COLUMN}` in rad/s, positive counter-clockwise seen from above"

    def look(self, seen: Seen) -> Finding | None:
        """Look at one that is learned from."""
        odd = [run_name(seen.runs, row[0]) for row in seen.evidence.gyro_turns if otherwise(row)]
        if not (seen.gyro and odd):
            return None
        return self._said("the gyro does not turn as the inputs do", odd[0], spoils=True)

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at those that are left out."""
        odd = [run.name for run in whole.log.runs if turns_otherwise(run, measured_rates(run))]
        what = "the gyro does not turn as the inputs do and is left out"
        return self._said(what, odd[0], spoils=False) if odd else None

    def _said(self, what: str, run: str, *, spoils: bool) -> Finding:
        advice = f"Give {COLUMN} in rad/s, positive counter-clockwise seen from above."
        return self.found(f"{what} (run {run})", advice, spoils=spoils)

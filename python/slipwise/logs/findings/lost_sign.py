# SPDX-License-Identifier: Apache-2.0
"""Finds motion that lost its sign: speeds, yaw rates or headings that go as far, but not always that way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.driven_windows import MOST_TURN
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.plausibility import correlation
from slipwise.logs.findings.robust_fit import robust_fit

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen
    from slipwise.logs.log import Bools, Floats
    from slipwise.logs.motion_windows import MotionWindows

_TURNS, _MOVES = 0.2, 0.1  # rad and m by inputs and poses, in a window that tells which way it goes
_FEWEST, _PART = 6, 0.1  # of such windows that go the other way; where inputs go both ways,
_FEWEST_OF_BOTH, _LATE_PART = 10, 0.25  # more, and of commands, which a robot follows late, a larger part
_TIMES = 3  # in some turns; a frame that is mirrored from some time on has one,
_LATE, _SO, _MORE = 3, 0.5, 0.2  # windows by which a robot may be late, and how they correlate then
_FOLLOWS, _FOLLOWS_SOME = 0.7, 0.3  # correlation of the sizes of both; unrelated ones have none
_AS_FAR, _MOST = 1.5, 0.6  # times as far at most, and so do most of them
_SOME, _BACK, _NEVER = 0.02, -0.1, -0.02  # quantile of windows; m by the sides: one goes back, one never does
_FEWEST_BACK, _PART_BACK = 8, 0.04  # windows in which it must have
_EXPLAINS, _ROUNDS = 0.7, 4  # of the misfit is left, at most; of sound logs 0.9
_LEAST_GAIN = 0.2  # of wheels
_HALVES = np.geomspace(0.05, 2.0, 24)  # m from the middle to a side


class LostSign(Check):
    """Motion that goes as far as the inputs say, now this way and now the other."""

    kind, family = "lost-sign", "signs and units"
    means = "a speed, a yaw rate or the heading lost its sign: an absolute value, an arc cosine, an arc sine"
    shows = (
        "a tenth of the windows and more go the other way, most of them as far; or one side never does where "
        "poses do"
    )
    cure = "record signed speeds; `yaw = atan2(2 (w z + x y), 1 - 2 (y y + z z))`"

    def look(self, seen: Seen) -> Finding | None:
        """Compare turns, then ways along the heading."""
        w, words = seen.windows, seen.words
        part = _other_way(w.turn, w.rotation, _TURNS)
        if part and _one_sided(w.rotation):
            return self._of_input(
                f"the {words.name} turn to one side alone", "yaw rate, or the heading,", part
            )
        if part > (_PART if seen.input_name == "wheel" else _LATE_PART) and not seen.positions:
            return self.found(
                f"in {100.0 * part:.0f} % of the turns the heading of the poses turns as far as the "
                f"{words.name} do, but to the other side: it lost its sign, or half of its circle",
                "Make the heading of atan2(2 (w z + x y), 1 - 2 (y y + z z)), not of acos, asin or abs.",
                evidence=part,
            )
        straight = (np.abs(w.turn) < MOST_TURN) & (np.abs(w.forward) > np.abs(w.sideways))
        way = (w.distance * np.cos(w.course_ahead(seen.sensor_yaw)))[straight]
        part = 0.0 if seen.positions else _other_way(way, w.forward[straight], _MOVES)
        if part and _one_sided(w.forward[straight]):
            return self._of_input(f"the {words.name} drive one way alone", "speed", part)
        return None if seen.positions else self._of_side(seen)

    def _of_side(self, seen: Seen) -> Finding | None:
        side, part = _side_without_sign(seen.windows_of("wheel"))
        if not side:
            return None
        return self.found(
            f"the {side} wheels never turn backwards, and in {100.0 * part:.0f} % of the windows the robot "
            "moves as if they did: their speed lost its sign",
            f"Look at both channels of the encoder of the {side} side: one alone counts forwards only.",
            evidence=part,
            spoils=seen.input_name == "wheel",
        )

    def _of_input(self, what: str, lost: str, part: float) -> Finding:
        return self.found(
            f"{what}, and in {100.0 * part:.0f} % the poses go the other: the {lost} lost its sign",
            f"Record the {lost} with its sign: forwards and to the left is positive.",
            evidence=part,
        )


def _side_without_sign(w: MotionWindows) -> tuple[str, float]:
    """Return the side whose speed has no sign, and in which part of the windows that shows; empty where none.

    How far the sides are apart is not known: of half tracks by which one side never goes back, the one is
    taken with which the wheels explain the poses best, once that side goes back where poses say so.
    """
    used = (np.maximum(np.abs(w.turn), np.abs(w.rotation)) < MOST_TURN) & np.isfinite(w.distance)
    done = np.stack((w.distance * np.cos(w.course_ahead(0.0)), w.turn))[:, used]
    given = np.stack((w.forward, w.rotation))[:, used]
    if given.shape[1] < _FEWEST_BACK:
        return "", 0.0
    arms = [arm for arm in (*-_HALVES, *_HALVES) if _never_goes_back(given, arm)]
    plain = _left_over(given, done) if arms else 0.0
    best = ("", 0.0, _EXPLAINS)
    for arm in arms:
        back, signed = _with_sign(given, arm, done)
        left, part = _left_over(signed, done) / plain, float(back.mean())
        if left < best[2] and np.count_nonzero(back) >= _FEWEST_BACK and part > _PART_BACK:
            best = ("left" if arm < 0.0 else "right", part, left)
    return best[:2]


def _never_goes_back(given: Floats, arm: float) -> bool:
    """Say whether the side `arm` [m] to the right of the middle never goes back, and the other one does."""
    mine, other = given[0] + arm * given[1], given[0] - arm * given[1]
    return bool(np.quantile(mine, _SOME) >= _NEVER and np.quantile(other, _SOME) <= _BACK)


def _with_sign(given: Floats, arm: float, done: Floats) -> tuple[Bools, Floats]:
    """Return in which windows a side without its sign went back, and ways and turns [2, N] with the sign."""
    mine, other = given[0] + arm * given[1], given[0] - arm * given[1]
    gains, signed = np.ones(2), given
    for _ in range(_ROUNDS):
        back = np.asarray(done[0] / gains[0] + arm * done[1] / gains[1] < 0.0)
        turned = np.where(back, -mine, mine)
        signed = np.stack((turned + other, (turned - other) / arm)) / 2.0
        gains = _gains(signed, done)
    return back, signed


def _gains(given: Floats, done: Floats) -> Floats:
    fits = [robust_fit(of[:, None], by)[0] for of, by in zip(given, done, strict=True)]
    return np.maximum([float(gain[0]) for gain in fits], _LEAST_GAIN)


def _left_over(given: Floats, done: Floats) -> float:
    """Return the mean misfit of ways and turns, each of its usual size."""
    gains = _gains(given, done)
    size = np.mean(np.abs(done), axis=1, keepdims=True) + _MOVES
    return float(np.mean(np.abs(done - gains[:, None] * given) / size))


def _other_way(done: Floats, given: Floats, least: float) -> float:
    """Return the part of windows that go the other way than is given, as far where that has both; or 0."""
    clear = np.minimum(np.abs(done), np.abs(given)) > least
    ratio = done[clear] / given[clear]
    along, against = np.abs(ratio[ratio > 0.0]), np.abs(ratio[ratio < 0.0])
    changes = np.count_nonzero(np.diff(np.sign(ratio)))
    one_sided = _one_sided(given)
    fewest = max(_FEWEST if one_sided else _FEWEST_OF_BOTH, _PART * len(ratio))
    if min(len(along), len(against)) < fewest or changes < _TIMES or _late(done, given):
        return 0.0
    follows = correlation(*(np.abs(each[clear]) - np.abs(each[clear]).mean() for each in (done, given)))
    sure = follows > _FOLLOWS_SOME if one_sided else follows > _FOLLOWS and _as_far(along, against)
    return len(against) / len(ratio) if sure else 0.0


def _as_far(along: Floats, against: Floats) -> bool:
    """Say whether most windows of either side go as far as is usual along."""
    usual = float(np.median(along))
    near = [np.abs(np.log(side / usual)) < math.log(_AS_FAR) for side in (along, against)]
    return bool(min(side.mean() for side in near) > _MOST)


def _late(done: Floats, given: Floats) -> bool:
    """Say whether windows do what was given in one before rather than what is."""
    now = correlation(done, given)
    return max(correlation(done[k:], given[:-k]) for k in range(1, _LATE + 1)) > max(_SO, now + _MORE)


def _one_sided(given: Floats) -> bool:
    return bool((given >= 0.0).all() or (given <= 0.0).all())

# SPDX-License-Identifier: Apache-2.0
"""Finders of changes that see the same windows: slipwise's own, CUSUM, Page-Hinkley, ADWIN, ruptures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import ruptures
from alarm_scores import Alarms, Course, Floats
from river.drift import ADWIN, PageHinkley

REST = 8  # windows after an alarm in which none is raised


def own(course: Course, threshold: float) -> Alarms:
    """The test that slipwise makes, at another threshold."""
    return _rested(np.flatnonzero(course.odds > threshold).tolist())


def cusum(stream: Floats, drift: float, threshold: float) -> Alarms:
    """Cumulative sums both ways (Page 1954) of a stream of unit variance, begun again by an alarm."""
    alarms, up, down = [], 0.0, 0.0
    for i, x in enumerate(stream.tolist()):
        up, down = max(0.0, up + x - drift), max(0.0, down - x - drift)
        if max(up, down) > threshold:
            alarms.append(i)
            up = down = 0.0
    return alarms


def standard(stream: Floats) -> Floats:
    """Scale a stream by its own spread so far, so that its size is not taken from the future."""
    count = np.arange(1, len(stream) + 1)
    size = np.sqrt((10.0 + np.cumsum(np.minimum(stream**2, 9.0))) / (10.0 + count))
    return stream / np.concatenate(([1.0], size[:-1]))


def cusum_signed(course: Course, setting: tuple[float, float]) -> Alarms:
    """CUSUM of both signed innovations; an alarm of either is one."""
    each = [cusum(standard(stream), *setting) for stream in course.signed.T]
    return _rested(sorted(each[0] + each[1]))


def cusum_nis(course: Course, setting: tuple[float, float]) -> Alarms:
    """CUSUM of the NIS, scaled to its mean and spread under a true model."""
    return _rested(cusum((course.nis - 3.0) / np.sqrt(6.0), *setting))


def page_hinkley(course: Course, setting: tuple[float, float]) -> Alarms:
    """River's Page-Hinkley test of both signed innovations, in both directions."""
    drift, threshold = setting
    found: Alarms = []
    for stream in course.signed.T:
        test = PageHinkley(min_instances=10, delta=drift, threshold=threshold, alpha=1.0)
        found += _river(test, standard(stream))
    return _rested(sorted(found))


def adwin(course: Course, delta: float) -> Alarms:
    """River's ADWIN of both signed innovations, asked at every window."""
    found: Alarms = []
    for stream in course.signed.T:
        found += _river(ADWIN(delta=delta, clock=1, min_window_length=2, grace_period=5), standard(stream))
    return _rested(sorted(found))


def offline(course: Course, penalty: float) -> Alarms:
    """PELT of `ruptures` over the whole drive: it knows what comes after, and has no delay of its own."""
    signal = np.column_stack([standard(stream) for stream in course.signed.T])
    breaks = ruptures.Pelt(model="l2", min_size=3, jump=2).fit(signal).predict(pen=penalty)
    return [int(b) for b in breaks[:-1]]


def _river(test: ADWIN | PageHinkley, stream: Floats) -> Alarms:
    found = []
    for i, x in enumerate(stream.tolist()):
        test.update(x)
        if test.drift_detected:
            found.append(i)
    return found


def _rested(alarms: Sequence[int]) -> Alarms:
    kept: Alarms = []
    for i in alarms:
        if not kept or i > kept[-1] + REST:
            kept.append(i)
    return kept


_CUSUM = [
    (k, h) for k in (0.1, 0.25, 0.5, 0.75, 1.0) for h in (2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 13.0, 17.0, 25.0)
]
FINDERS: Mapping[str, tuple[Callable[..., Alarms], Sequence[object]]] = {
    "slipwise": (own, [0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.5, 11.0, 13.0, 16.0, 20.0]),
    "CUSUM of innovations": (cusum_signed, _CUSUM),
    "CUSUM of NIS": (cusum_nis, _CUSUM),
    "Page-Hinkley": (
        page_hinkley,
        [(k, h) for k in (0.005, 0.1, 0.25, 0.5) for h in (2.0, 4.0, 6.0, 8.0, 12.0, 17.0, 25.0, 40.0)],
    ),
    "ADWIN": (adwin, [1e-5, 1e-4, 1e-3, 2e-3, 1e-2, 3e-2, 0.1, 0.3, 0.6]),
    "ruptures, off-line": (offline, [2.0, 4.0, 6.0, 8.0, 11.0, 15.0, 20.0, 30.0, 50.0]),
}

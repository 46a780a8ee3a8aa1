# SPDX-License-Identifier: Apache-2.0
"""Makes a stream of positions without headings out of the fixes of a satellite receiver's track."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from slipwise.logs.left_out import Tally
from slipwise.logs.navsat import ecef, in_tangent_plane
from slipwise.logs.streams import RawStream

Fix = tuple[float, float, float, float]  # t [s], latitude, longitude [deg], height [m] or NaN
_FARTHEST = 1e5  # [m] of a fix from the middle of its track; beyond it, no plane is tangent to both
_HIGHEST = 1e5  # [m]


def track_stream(path: Path, unit: str, fixes: Iterable[tuple[int, Fix | None]], tally: Tally) -> RawStream:
    """Return fixes as positions [m], x east and y north in the plane tangent at the first of them.

    The first fix of a receiver that just woke up may be anywhere: the plane is that of the first fix that
    lies near the middle of all, and those that do not are left out and counted.

    Args:
        path: the file, for messages.
        unit: what a number counts: "line" or "point".
        fixes: each with its number; None where it has no time or no place.
        tally: counts rejected samples.
    """
    rows, numbers, unusable = [], [], []
    for number, fix in fixes:
        if fix is None or not _is_place(fix):
            unusable.append(number)
        else:
            rows.append(fix)
            numbers.append(number)
    values = np.array(rows, dtype=np.float64).reshape(-1, 4)
    found = np.array(numbers, dtype=np.int64)

    def place(number: int) -> str:
        return f"{path.name}, {unit} {number}"

    tally.add_lines("poor-fix", "fixes without a time or a place", unusable, place)
    t, latitude, longitude, height = values.T
    known = np.nan_to_num(height, nan=float(np.nanmedian(height)) if not np.isnan(height).all() else 0.0)
    points = ecef(latitude, longitude, known)
    near = np.linalg.norm(points - np.median(points, axis=0), axis=1) < _FARTHEST if len(points) else []
    near = np.asarray(near, dtype=bool)
    if not near.all():
        where = place(int(found[np.argmin(near)]))
        reason = f"fixes further than {_FARTHEST / 1e3:g} km from the middle of the track"
        tally.add("poor-fix", reason, count=int((~near).sum()), where=where)
    first = int(np.argmax(near)) if near.any() else 0
    origin = slice(first, first + 1)
    places = np.empty((0, 3))
    if len(points):
        places = in_tangent_plane(points, latitude[origin], longitude[origin], known[origin])
    columns = {"x": places[:, 0], "y": places[:, 1], "z": np.where(np.isnan(height), np.nan, places[:, 2])}
    return RawStream("poses", t, columns, found, place, frozenset(("z",))).select(near)


def _is_place(fix: Fix) -> bool:
    """Whether a fix has a time and lies on the earth; comparisons with NaN are false."""
    t, latitude, longitude, height = fix
    on_earth = abs(latitude) <= 90.0 and abs(longitude) <= 180.0
    return on_earth and abs(t) < np.inf and not abs(height) >= _HIGHEST

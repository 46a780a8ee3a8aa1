# SPDX-License-Identifier: Apache-2.0
"""What the page of the live node is sent: the texts and the few numbers that it draws, as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from slipwise.ellipse import outline_of
from slipwise.live.outputs import Floats, NextMovesNow, ParameterNow, Path, Status
from slipwise.live.watch.history import Seen
from slipwise.live.watch.status_texts import (
    SLIP_NAMES,
    after_text,
    error_texts,
    move_text,
    nis_text,
    parameter_texts,
    slip_texts,
    stamp_text,
    sure_text,
    surface_text,
)

_MOST_POINTS = 500  # of the driven path
_PLACES = 3  # mm, mrad
_RADIUS = math.sqrt(-2.0 * math.log(0.05))  # standard deviations around 95 % of a normal in a plane
_MOST = 6


def snapshot(seen: Seen) -> str:
    """Return what there is to show as one line of JSON; null stands for what is not finite."""
    status = seen.status
    content: dict[str, Any] = {
        "log": [[stamp_text(t), text] for t, text in seen.notes],
        "path": {
            "driven": [] if status is None else _points(_thinned(status.driven)),
            "fused": _points(seen.fused),
            "predicted": [] if seen.predicted is None else _points(seen.predicted.poses),
            "ellipses": []
            if seen.predicted is None
            else [_points(ring) for ring in path_ellipses(seen.predicted)],
            "robot": _robot(seen),
        },
        "nis": [[segment - seen.nis[-1][0], _round(value)] for segment, value in seen.nis],
        "status": None if status is None else _status(status),
        "next": None if seen.next_moves is None else _next(seen.next_moves),
    }
    return json.dumps(content, allow_nan=False, separators=(",", ":"))


def _status(status: Status) -> dict[str, Any]:
    slip = slip_texts(status)
    return {
        "stamp": stamp_text(status.t),
        "vehicle": status.vehicle,
        "input": status.input,
        "apply": status.apply,
        "state": status.state,
        "why": status.why,
        "validity": status.validity,
        "validityWhy": status.validity_why,
        "segments": status.segments,
        "surface": surface_text(status),
        "frame": status.odometry.frame if status.odometry is not None else "",
        "sincePose": None if status.odometry is None else _round(status.odometry.since_pose),
        "parameters": [_parameter(parameter) for parameter in status.parameters],
        "slip": None
        if slip is None or status.slip is None
        else [
            {"name": name, "unit": unit, "text": text, "value": _round(value)}
            for (name, unit), text, value in zip(SLIP_NAMES, slip, status.slip.tolist(), strict=True)
        ],
        "nis": nis_text(status),
        "errors": [vars(error) for error in error_texts(status)],
        "counts": sorted(status.counts.items(), key=lambda item: -item[1]),
    }


def _next(now: NextMovesNow) -> dict[str, Any]:
    """Return the moves worth driving, and how sure the worst prediction is."""
    return {
        "why": now.why,
        "moves": [
            {
                "v": _round(move.v),
                "omega": _round(move.omega),
                "seconds": _round(move.seconds),
                "text": move_text(move),
                "after": after_text(move),
                "teaches": move.teaches,
            }
            for move in now.moves
        ],
        "sure": [{"name": s.name, "text": sure_text(s), "known": _share(s.known)} for s in now.predictions],
    }


def _share(known: float | None) -> float | None:
    return None if known is None else _round(known)


def _parameter(parameter: ParameterNow) -> dict[str, Any]:
    """Return a parameter's texts, and its places in standard deviations of the prior from its start."""
    scale = parameter.prior_std
    drawn = scale > 0.0 and math.isfinite(scale)

    def place(value: float) -> float | None:
        return _round((value - parameter.start) / scale) if drawn else None

    return {
        **vars(parameter_texts(parameter)),
        "at": place(parameter.value),
        "spread": _round(parameter.std / scale) if drawn else None,
        "appliedAt": None if parameter.applied is None else place(parameter.applied),
        "known": _share(parameter.known),
    }


def _robot(seen: Seen) -> list[float | None] | None:
    """Return where the robot is: fused, or as last measured; x, y [m], yaw [rad]."""
    if seen.odometry is not None:
        return [_round(value) for value in seen.odometry.pose.tolist()]
    if seen.status is not None and len(seen.status.driven):
        return [_round(value) for value in seen.status.driven[-1].tolist()]
    return None


def _thinned(driven: Floats) -> Floats:
    step = -(-len(driven) // _MOST_POINTS)
    return driven if step <= 1 else driven[::-1][::step][::-1]  # the newest stays


def _points(rows: Floats | Sequence[Sequence[float]]) -> list[list[float | None]]:
    """Return x and y of [N, 2] or more apart, as they are drawn."""
    if len(rows) == 0:
        return [[], []]
    points = np.asarray(rows, dtype=np.float64)
    if np.isfinite(points).all():
        return [points[:, i].round(_PLACES).tolist() for i in (0, 1)]
    return [[_round(value) for value in points[:, i].tolist()] for i in (0, 1)]


def _round(value: float) -> float | None:
    return round(value, _PLACES) if math.isfinite(value) else None


def path_ellipses(path: Path) -> list[Floats]:
    """Return closed outlines [points, 2] around 95 %, in m, at a few poses, the last among them."""
    count = len(path.poses)
    if count == 0:
        return []
    chosen = np.unique(np.linspace((count - 1) / _MOST, count - 1, _MOST).round().astype(int)).tolist()
    outlines = (outline_of(path.poses[i, :2], path.covariance[i, :2, :2], _RADIUS) for i in chosen)
    return [outline[::2] for outline in outlines if outline is not None]

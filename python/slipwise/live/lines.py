# SPDX-License-Identifier: Apache-2.0
"""Samples as lines of text, for makers and microcontrollers: CSV with a header, or JSON objects."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping

from slipwise.errors import LogError
from slipwise.live.outputs import (
    AppliedParameters,
    ModelText,
    NextMovesNow,
    Odometry,
    Output,
    Path,
    Status,
    SurfaceNow,
    next_moves_content,
    surface_content,
)
from slipwise.live.samples import Command, Override, Pose, Request, RunStart, Sample, SurfaceCue, Wheels
from slipwise.logs.fixes import FIXES, fix_number

MOST_BYTES = 10_000  # of a line

_COMMAND = ("cmd_v", "cmd_omega")
_WHEELS = ("odo_v", "odo_omega")
_POSE = ("x", "y", "yaw")


class LineReader:
    """Turns lines into samples. Columns are those of a tidy log; an empty cell, or none, is no measurement.

    One line may hold a command, wheel speeds and a pose of one stamp. A JSON line may ask, too:
    {"apply": true} or {"predict": {"horizon": 2, "commands": [[t, v, omega], ...]}}; and
    it may say what the ground is: {"terrain": "sand"}, or {"terrain_changed": true}.
    """

    def __init__(self) -> None:
        self._header: list[str] | None = None

    def read(self, line: str) -> list[Sample]:
        """Return the samples of a line.

        Raises:
            LogError: the line is none of these; it says why.
        """
        text = line.strip()
        if not text or text.startswith("#"):
            return []
        if len(text) > MOST_BYTES:
            raise LogError("a line is too long", advice=f"write {MOST_BYTES} bytes at most")
        if text.startswith("{"):
            return _of_json(text)
        cells = _cells(text)
        if self._header is None or "t" in cells:
            self._header = [cell.strip() for cell in cells]
            if "t" not in self._header:
                self._header = None
                raise LogError(
                    "lines come before a header", advice="start with t,odo_v,odo_omega,x,y,yaw or the like"
                )
            return []
        if len(cells) != len(self._header):
            raise LogError(f"{len(cells)} cells where the header has {len(self._header)}")
        filled = zip(self._header, cells, strict=True)
        return samples_of_row({name: cell for name, cell in filled if cell.strip() != ""})


def _cells(text: str) -> list[str]:
    try:
        return next(csv.reader([text]), [])
    except csv.Error as problem:
        raise LogError(f"not a line of CSV: {problem}") from problem


def samples_of_row(row: Mapping[str, object]) -> list[Sample]:
    """Return the samples of one stamp, commands first, poses last.

    Raises:
        LogError: a cell is no number, or there is no stamp.
    """
    if "t" not in row:
        raise LogError("there is no t, the stamp in seconds")
    t = _number(row, "t")
    found: list[Sample] = _labels(row)
    if "override" in row:
        found.append(Override(t, bool(_number(row, "override"))))
    if all(name in row for name in _COMMAND):
        v, omega = _number(row, "cmd_v"), _number(row, "cmd_omega")
        found.append(Command(t, v, omega, _number(row, "cmd_vy", 0.0)))
    if all(name in row for name in _WHEELS):
        v, omega = _number(row, "odo_v"), _number(row, "odo_omega")
        found.append(Wheels(t, v, omega, _number(row, "odo_vy", 0.0)))
    if all(name in row for name in _POSE):
        found.append(_pose_of(t, row))
    return found


def _labels(row: Mapping[str, object]) -> list[Sample]:
    """What the line says of the ground, before what it measures: as a log's column `terrain` is read."""
    label = str(row.get("terrain", "")).strip()
    return [SurfaceCue(label)] if label else []


def _pose_of(t: float, row: Mapping[str, object]) -> Pose:
    return Pose(
        t,
        _number(row, "x"),
        _number(row, "y"),
        _number(row, "yaw"),
        std_xy=_known(row, "std_xy"),
        std_yaw=_known(row, "std_yaw"),
        frame=str(row.get("frame", "")),
        roll=_known(row, "roll"),
        pitch=_known(row, "pitch"),
        source=str(row.get("source", "")),
        fix=FIXES[fix_number(str(row.get("fix", "")))],
    )


def _of_json(text: str) -> list[Sample]:
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as problem:
        raise LogError(f"not a JSON object: {problem}") from problem
    if not isinstance(content, dict):
        raise LogError("not a JSON object")
    if "predict" in content:
        return [Request("predict", json.dumps(content["predict"]))]
    if content.get("terrain_changed") is True:
        return [SurfaceCue()]
    if "terrain" in content and "t" not in content:
        return _labels(content)
    if content.get("apply") is True:
        return [Request("apply")]
    if "run" in content and "t" not in content:
        return [RunStart(str(content["run"]))]
    return samples_of_row({name: value for name, value in content.items() if value is not None})


def _number(row: Mapping[str, object], name: str, default: float = math.nan) -> float:
    if name not in row:
        return default
    try:
        return float(row[name])  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError) as problem:
        raise LogError(f"{name} is {str(row[name])[:40]!r}, not a number") from problem


def _known(row: Mapping[str, object], name: str) -> float | None:
    return _number(row, name) if name in row else None


def line_of(output: Output) -> str:
    """Return an output as one line of JSON without its end."""
    return json.dumps(_content(output), allow_nan=False)


def _content(output: Output) -> dict[str, object]:
    if isinstance(output, Odometry):
        return {
            "odometry": _finite(output.pose.tolist()),
            "t": output.t,
            "covariance": _finite(output.pose_covariance.ravel().tolist()),
            "twist": _finite(output.twist.tolist()),
            "twist_covariance": _finite(output.twist_covariance.ravel().tolist()),
            "frame": output.frame,
            "since_pose": output.since_pose,
        }
    if isinstance(output, Path):
        return {
            "prediction" if output.asked else "predicted_path": output.poses.tolist(),
            "t": output.t.tolist(),
            "covariance": [_finite(each.ravel().tolist()) for each in output.covariance],
        }
    if isinstance(output, Status):
        return {
            "state": output.state,
            "t": output.t if math.isfinite(output.t) else None,
            "why": output.why,
            "validity": output.validity,
            "parameters": {
                p.name: {"value": p.value, "std": p.std, "validity": p.validity, "applied": p.applied}
                for p in output.parameters
            },
            "counts": output.counts,
        }
    if isinstance(output, SurfaceNow):
        return surface_content(output) | {"t": output.t}
    if isinstance(output, NextMovesNow):
        return {"next_moves": next_moves_content(output), "t": output.t if math.isfinite(output.t) else None}
    if isinstance(output, ModelText):
        return {"model": output.text, "t": output.t}
    if isinstance(output, AppliedParameters):
        return {"set": output.values, "node": output.node, "target": output.target}
    return {"note": output.text, "t": output.t if math.isfinite(output.t) else None}


def _finite(values: list[float]) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in values]

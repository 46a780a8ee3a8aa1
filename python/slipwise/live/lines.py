# SPDX-License-Identifier: Apache-2.0
"""Samples as lines of text, for makers and microcontrollers: CSV with a header, or JSON objects."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping, Sequence

from slipwise.errors import LogError
from slipwise.live.outputs import (
    AppliedParameters,
    ModelText,
    NextMovesNow,
    NoPrediction,
    Odometry,
    Output,
    Path,
    Status,
    SurfaceNow,
    next_moves_content,
    surface_content,
)
from slipwise.live.samples import Override, Request, RunStart, Sample, SurfaceCue, Unusable
from slipwise.logs.findings.finding import Finding
from slipwise.logs.options import LogOptions
from slipwise.logs.row_reader import RowReader, number_of
from slipwise.logs.table import EMPTY_CELLS

MOST_BYTES = 10_000  # of a line
_AS_IT_IS = LogOptions()

_FURTHER = ("override",)  # what a line may say beside a row of a log


class LineReader:
    """Turns lines into samples: a line is a row of a tidy log, and read as one.

    Columns are those of a tidy log; an empty cell, or none, is no measurement. A JSON line may ask, too:
    {"apply": true} or {"predict": {"horizon": 2, "commands": [[t, v, omega], ...]}}, yaw rates of what steers
    too; and it may say what the ground is: {"terrain": "sand"}, or {"terrain_changed": true}.

    Args:
        options: how rows are read.

    Raises:
        SettingsError: the options name columns that there are not, or ask for what takes a whole log.
    """

    def __init__(self, options: LogOptions = _AS_IT_IS) -> None:
        self._rows = RowReader(options, _FURTHER)
        self._header: list[str] | None = None
        self._run: str | None = None
        self.columns: set[str] = set()  # that lines had so far
        self.notes: list[str] = []  # what was worked out, since somebody looked

    def found(self) -> tuple[Finding, ...]:
        """Return what the lines so far show to be wrong."""
        return self._rows.found()

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
            return self._of_json(text)
        cells = _cells(text)
        names = self._rows.renamed([cell.strip() for cell in cells])
        if "t" in names and not _is_number(cells[names.index("t")]):
            self._header = names
            self.columns.update(names)
            return []
        if self._header is None and "t" in names:  # columns by number need no header
            self._header = names
            self.columns.update(names)
        if self._header is None:
            raise LogError(
                "lines come before a header", advice="start with t,odo_v,odo_omega,x,y,yaw or the like"
            )
        if len(cells) != len(self._header):
            raise LogError(f"{len(cells)} cells where the header has {len(self._header)}")
        filled = zip(self._header, cells, strict=True)
        return self._of_row(
            {name: cell for name, cell in filled if cell.strip() not in EMPTY_CELLS}, self._header
        )

    def _of_row(self, cells: Mapping[str, object], names: Sequence[str]) -> list[Sample]:
        """Return the samples of one stamp: labels first, then measurements in the order of their kinds."""
        found: list[Sample] = []
        run = str(cells["run"]).strip() if "run" in cells else self._run
        if run != self._run:
            self._run = run
            self._rows.restart()
            found.append(RunStart(str(run)))
        row = self._rows.read(cells, names)
        self.notes += row.notes
        found += [Unusable(reason, text, kind=text) for reason, text in row.left_out]
        if row.label:
            found.append(SurfaceCue(row.label))
        if "override" in cells:
            found.append(Override(number_of(cells, "t"), bool(number_of(cells, "override"))))
        return [*found, *row.measurements]

    def _of_json(self, text: str) -> list[Sample]:
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
        if "t" not in content and content.get("terrain"):
            return [SurfaceCue(str(content["terrain"]))]
        if content.get("apply") is True:
            return [Request("apply")]
        if "run" in content and "t" not in content:
            self._run = str(content["run"])
            self._rows.restart()
            return [RunStart(self._run)]
        filled = {name: value for name, value in content.items() if value is not None}
        names = self._rows.renamed(list(filled))
        if len(self.columns) < MOST_BYTES:
            self.columns.update(names)
        return self._of_row(dict(zip(names, filled.values(), strict=True)), names)


def _cells(text: str) -> list[str]:
    try:
        return next(csv.reader([text]), [])
    except csv.Error as problem:
        raise LogError(f"not a line of CSV: {problem}") from problem


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


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
    if isinstance(output, NoPrediction):
        return {"prediction": None, "why": output.why}
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

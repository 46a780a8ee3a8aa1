# SPDX-License-Identifier: Apache-2.0
"""The page of a fleet: vehicles side by side, drift, what stands out, and logs that could not be used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.fleet.findings import (
    FALSE_DISCOVERIES,
    FEWEST_LOGS,
    Finding,
    ParameterFindings,
    rows_by_parameter,
)
from slipwise.reporting.figure import Figure, axis, baseline_label, numbers
from slipwise.reporting.markup import bullets, missing, number, table
from slipwise.reporting.page import Part, page_of
from slipwise.reporting.thinning import CURVE_POINTS, thinned

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7a4fa3", "#4d4d4d")
FLEET = "#1b2430"
TWO_SIGMA = 2.0
FEWEST_POINTS = 20  # of a vehicle that are drawn of one parameter
MOST_ROWS = 500  # of unusable logs that are listed

Columns = Mapping[str, NDArray[Any]]
Rows = Mapping[str, NDArray[np.int64]]  # of one parameter, by vehicle


def fleet_page(
    columns: Columns, findings: Sequence[ParameterFindings], unusable: Sequence[Mapping[str, Any]]
) -> str:
    """Return one self-contained HTML page that works offline."""
    rows = rows_by_parameter(columns) if columns else {}
    parts = (
        Part(
            "The fleet", "What was learned of how many logs.", bullets(summary(columns, findings, unusable))
        ),
        Part(
            "What stands out",
            f"Vehicles unlike the others, and parameters that drift; {FALSE_DISCOVERIES:.0%} of the alarms "
            "are false ones at most (Benjamini and Hochberg), over all vehicles and parameters.",
            _alarms(findings),
        ),
        Part(
            "Vehicles side by side",
            "Logs with two standard deviations, evenly thinned where there are many, and what the fleet "
            "expects of its next robot.",
            "".join(_side_by_side(columns, each, rows[each.parameter]).html() for each in findings)
            or missing("There is no log that could be used."),
            folded=True,
        ),
        Part(
            "Over time",
            "The same values by the day of the log.",
            "".join(_over_time(columns, each, rows[each.parameter]).html() for each in findings)
            or missing("There is no log that could be used."),
            folded=True,
        ),
        Part("Logs that could not be used", "And why.", _unusable(unusable), folded=True),
    )
    return page_of("A fleet", "slipwise fleet", parts)


def summary(
    columns: Columns, findings: Sequence[ParameterFindings], unusable: Sequence[Mapping[str, Any]]
) -> list[str]:
    """Return the fleet in a few sentences."""
    if not columns:
        return [f"None of {len(unusable)} logs could be used."]
    keys, first = np.unique(columns["key"], return_index=True)
    vehicles = np.unique(columns["vehicle"])
    good = int(columns["good"][first].sum())
    hours = float(columns["seconds"][first].sum()) / 3600.0
    alarms = [finding for each in findings for finding in each.findings if finding.alarm]
    tests = sum(len(each.findings) for each in findings)
    driven = (
        f"{len(keys)} logs of {len(vehicles)} vehicles, {number(hours)} h of driving; {good} with a good "
        "verdict."
    )
    tested = (
        f"{len(alarms)} alarms of {tests} tests. A vehicle is compared with the others where there are three "
        f"or more, its drift is tested from {FEWEST_LOGS} logs on."
    )
    return [driven, f"{len(unusable)} logs could not be used.", tested]


def _alarms(findings: Sequence[ParameterFindings]) -> str:
    units = {each.parameter: each.unit for each in findings}
    alarms = [finding for each in findings for finding in each.findings if finding.alarm]
    if not alarms:
        return missing("Nothing stands out.")
    alarms.sort(key=lambda finding: finding.chance)
    return table(
        ("vehicle", "parameter", "what", "by", "standard deviation", "chance", "walk in a km", "now"),
        [_alarm_row(finding, units[finding.parameter]) for finding in alarms],
    )


def _alarm_row(finding: Finding, unit: str) -> tuple[str, ...]:
    what = "unlike the others" if finding.kind == "odd" else "drifts, per 30 days"
    size, std = f"{number(finding.size)} {unit}", f"{number(finding.std)} {unit}"
    walk, now = number(finding.walk), number(finding.now)
    return finding.vehicle, finding.parameter, what, size, std, number(finding.chance), walk, now


def _side_by_side(columns: Columns, found: ParameterFindings, rows: Rows) -> Figure:
    traces = []
    for place, vehicle in enumerate(found.vehicles):
        drawn = _drawn(rows[vehicle], len(found.vehicles))
        label = baseline_label(vehicle)
        traces.append(_points(columns, drawn, vehicle, place) | {"x": [label] * len(drawn)})
    if found.prior is not None:
        mean = float(found.prior.mean[0])
        spread = TWO_SIGMA * float(np.sqrt(found.prior.new_robot[0, 0]))
        labels = [baseline_label(vehicle) for vehicle in found.vehicles]
        for value, dash in ((mean, "solid"), (mean - spread, "dot"), (mean + spread, "dot")):
            line = {"color": FLEET, "dash": dash, "width": 1.2}
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines",
                    "x": labels,
                    "y": numbers([value] * len(labels)),
                    "line": line,
                }
            )
    return _figure("vehicles", found, traces, axis("", type="category"))


def _over_time(columns: Columns, found: ParameterFindings, rows: Rows) -> Figure:
    traces = []
    for place, vehicle in enumerate(found.vehicles):
        drawn = _drawn(rows[vehicle], len(found.vehicles))
        start = columns["start"][drawn].astype(float)
        days = [datetime.fromtimestamp(t, UTC).strftime("%Y-%m-%d %H:%M:%S") for t in start.tolist()]
        traces.append(_points(columns, drawn, vehicle, place) | {"x": days})
    layout = axis("day", type="date")
    return _figure("time", found, traces, layout)


def _figure(key: str, found: ParameterFindings, traces: list[dict[str, Any]], x: dict[str, Any]) -> Figure:
    unit = "" if found.unit == "-" else f" [{found.unit}]"
    return Figure(
        key=f"{key}-{found.parameter}",
        label=f"{found.parameter} of every vehicle",
        heading=found.parameter,
        traces=traces,
        layout={"xaxis": x, "yaxis": axis(f"value{unit}")},
        height=260,
    )


def _drawn(rows: NDArray[np.int64], vehicles: int) -> NDArray[np.int64]:
    """Return the rows of one vehicle and parameter that are drawn, evenly thinned where they are many."""
    return rows[thinned(len(rows), max(FEWEST_POINTS, CURVE_POINTS // vehicles))]


def _points(columns: Columns, rows: NDArray[np.int64], vehicle: str, place: int) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "markers",
        "y": numbers(columns["value"][rows].astype(float)),
        "error_y": {"type": "data", "array": numbers(TWO_SIGMA * columns["std"][rows].astype(float))},
        "marker": {"color": COLOURS[place % len(COLOURS)]},
        "name": baseline_label(vehicle),
    }


def _unusable(unusable: Sequence[Mapping[str, Any]]) -> str:
    if not unusable:
        return missing("All logs could be used.")
    rows = [
        (str(entry["log"]), str(entry["vehicle"]), str(entry["failure"])) for entry in unusable[:MOST_ROWS]
    ]
    more = "" if len(unusable) <= MOST_ROWS else missing(f"And {len(unusable) - MOST_ROWS} more.")
    return table(("log", "vehicle", "why"), rows) + more

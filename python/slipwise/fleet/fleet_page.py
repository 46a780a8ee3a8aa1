# SPDX-License-Identifier: Apache-2.0
"""The page of a fleet: a table of vehicles, what stands out, charts, and logs that could not be used."""

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
from slipwise.fleet.log_kinds import logs_of_kinds
from slipwise.fleet.vehicle_numbers import logs_of, types_apart
from slipwise.models.parameter_table import physical_name
from slipwise.number_text import DASH, count_text
from slipwise.reporting.figure import CURVE_POINTS, Figure, axis, baseline_label, numbers, thinned
from slipwise.reporting.markup import (
    bullets,
    details,
    escape,
    grid,
    missing,
    number,
    paragraph,
    scrolling,
    table,
)
from slipwise.reporting.page import Part, page_of

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7a4fa3", "#4d4d4d")
FLEET = "#1b2430"
_NAMED = 5  # alarms in a sentence
SHOWN_AT_ONCE = 8  # charts of a section; the others are folded away
_SHOWN = (  # heading, number of a vehicle, its scale and unit
    ("drives", "drives", 100.0, " %"),
    ("turns", "turns", 100.0, " %"),
    ("separation<br>multiplier", "multiplier", 1.0, ""),
    ("lag of<br>speed", "lag_speed", 1.0, " s"),
    ("lag of<br>yaw rate", "lag_turn", 1.0, " s"),
    ("error", "error", 1.0, " m"),
    ("baseline's", "baseline", 1.0, " m"),
    ("heading<br>error", "error_heading", float(np.degrees(1.0)), "°"),
    ("baseline's", "baseline_heading", float(np.degrees(1.0)), "°"),
)
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
    ordered = sorted(findings, key=_difference, reverse=True)
    none = missing("There is no log that could be used.")
    beside = [_side_by_side(columns, each, rows[each.parameter]).html() for each in ordered]
    course = [_over_time(columns, each, rows[each.parameter]).html() for each in ordered]
    parts = (
        Part(
            "The fleet",
            "The median of each vehicle's logs, below it their least and most. It drives and turns so much "
            "of what is commanded, or of what the wheels say; a lag is the time to 63 % of a step; errors "
            "are those of held-out predictions at the longest horizon.",
            _summary(columns, findings, unusable) + (_vehicles(columns) if columns else ""),
        ),
        Part(
            "What stands out",
            f"Vehicles unlike the others, and parameters that drift; {FALSE_DISCOVERIES:.0%} of the alarms "
            "are false ones at most (Benjamini and Hochberg), over all vehicles and parameters.",
            _alarms(findings),
        ),
        Part(
            "Vehicles side by side",
            "Logs with two standard deviations, what differs most between vehicles first; lines: what the "
            "fleet expects of its next robot.",
            _charts(beside) or none,
        ),
        Part("Over time", "The same values by the day of the log.", _charts(course) or none, folded=True),
        Part("Logs that could not be used", "And why.", _unusable(unusable), folded=True),
    )
    return page_of("A fleet", "slipwise fleet", parts)


def _charts(figures: Sequence[str]) -> str:
    """Show the first charts and fold the others away."""
    first, rest = (grid(some) if some else "" for some in (figures[:SHOWN_AT_ONCE], figures[SHOWN_AT_ONCE:]))
    return first + (details(f"{len(figures) - SHOWN_AT_ONCE} more parameters", rest) if rest else "")


_ASKED = ("lon.V", "ang.w", "speed per throttle", "curvature per steering")  # parameters


def _difference(found: ParameterFindings) -> float:
    """Return how much vehicles differ in a parameter, in standard deviations of each vehicle's estimate."""
    return float(np.std(found.estimate) / max(float(np.median(found.std)), 1e-12))


def _vehicles(columns: Columns) -> str:
    """Return the table of vehicles."""
    rows = []
    for vehicle, of in logs_of(columns).items():
        hours, good = float(columns["seconds"][of].sum()) / 3600.0, int(columns["good"][of].sum())
        cells = [_spread(columns, name, of, scale, unit) for _, name, scale, unit in _SHOWN]
        cells += [f"{len(of)}<small>{good} good</small>", f"{number(hours, 2)} h"]
        body = "".join(f"<td>{cell}</td>" for cell in cells)
        rows.append(f'<tr><th scope="row">{escape(vehicle)}</th>{body}</tr>')
    heads = ("vehicle", *(head for head, *_ in _SHOWN), "logs", "driven")
    head = "".join(f'<th scope="col">{each}</th>' for each in heads)
    html = f'<table class="scores"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
    return scrolling(html)


def _spread(columns: Columns, name: str, rows: NDArray[np.int64], scale: float, unit: str) -> str:
    """Return the median over a vehicle's logs, and their least and most where they differ."""
    values = scale * columns[name][rows].astype(float)
    values = values[np.isfinite(values)]
    if not len(values):
        return DASH
    low, middle, high = (number(float(value), 2) for value in np.quantile(values, (0.0, 0.5, 1.0)))
    return f"{middle}{unit}" + (f"<small>{low} to {high}</small>" if low != high else "")


def _summary(
    columns: Columns, findings: Sequence[ParameterFindings], unusable: Sequence[Mapping[str, Any]]
) -> str:
    """Return the fleet in a few sentences, a warning of two types of robot as a banner."""
    warned = types_apart(columns) if columns else ""
    sentences = [text for text in summary(columns, findings, unusable) if text != warned]
    return bullets(sentences) + (f'<div class="verdict reserved">{paragraph(warned)}</div>' if warned else "")


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
    alarms = _by_chance(findings)
    tests = sum(len(each.findings) for each in findings)
    driven = (
        f"{len(keys)} logs of {len(vehicles)} vehicles, {number(hours)} h of driving; {good} with a good "
        "verdict."
    )
    tested = (
        f"{count_text(len(alarms), 'alarm')} of {count_text(tests, 'test')}{_whose(alarms)}. "
        "A vehicle is compared with the others where there are three or more, "
        f"its drift is tested from {FEWEST_LOGS} logs on."
    )
    kinds = logs_of_kinds(columns)
    apart = ", ".join(f"{count} from {kind}" for kind, count in kinds.most_common())
    warned = types_apart(columns)
    left = "1 log" if len(unusable) == 1 else f"{len(unusable)} logs"
    return [
        driven,
        *([f"{left} could not be used."] if unusable else []),
        *([f"Logs were learned {apart}: each is compared with its like alone."] if len(kinds) > 1 else []),
        *([warned] if warned else []),
        tested,
        *_least_words(findings),
    ]


def _least_words(findings: Sequence[ParameterFindings]) -> list[str]:
    """Say how large a difference these logs could show, in what an owner asks for first."""
    said = []
    for each in findings:
        least = [finding.least for finding in each.findings if finding.kind == "odd"]
        if each.parameter in _ASKED and least:
            said.append(f"{number(min(least), 2)} {each.unit} in {each.parameter}")
    words = f"With these logs a vehicle unlike the others stands out from {', '.join(said)} on."
    return [words] if said else []


def _by_chance(findings: Sequence[ParameterFindings]) -> list[Finding]:
    """Return the alarms, the least likely by chance first."""
    alarms = [finding for each in findings for finding in each.findings if finding.alarm]
    return sorted(alarms, key=lambda finding: finding.chance)


def _whose(alarms: Sequence[Finding]) -> str:
    """Say which vehicles alarm and by what, the first few."""
    if not alarms:
        return ""
    what = {"odd": "is unlike the others in", "drift": "drifts in"}
    named = [f"{each.vehicle} {what[each.kind]} {physical_name(each.parameter)}" for each in alarms]
    more = f" and {len(named) - _NAMED} more" if len(named) > _NAMED else ""
    return f": {', '.join(named[:_NAMED])}{more}"


def _alarms(findings: Sequence[ParameterFindings]) -> str:
    units = {each.parameter: each.unit for each in findings}
    alarms = _by_chance(findings)
    if not alarms:
        return missing("Nothing stands out.")
    return table(
        ("vehicle", "parameter", "what", "by", "standard deviation", "chance", "walk in a km", "now"),
        [_alarm_row(finding, units[finding.parameter]) for finding in alarms],
    )


def _alarm_row(finding: Finding, unit: str) -> tuple[str, ...]:
    what = "unlike the others" if finding.kind == "odd" else "drifts, per 30 days"
    name, logarithm = physical_name(finding.parameter), _logarithm(finding.parameter)
    size, std, walk = (
        f"{number(100.0 * np.expm1(value))} %" if logarithm else f"{number(value)} {unit}"
        for value in (finding.size, finding.std, finding.walk)
    )
    now = number(float(_physical(finding.parameter, np.array([finding.now]))[0]))
    return finding.vehicle, name, what, size, std, number(finding.chance), walk, now


def _logarithm(parameter: str) -> bool:
    """Say whether a parameter is learned as a logarithm; it is shown in its own unit."""
    return physical_name(parameter) != parameter


def _physical(parameter: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.exp(values) if _logarithm(parameter) else values


def _side_by_side(columns: Columns, found: ParameterFindings, rows: Rows) -> Figure:
    traces = []
    for place, vehicle in enumerate(found.vehicles):
        drawn = _drawn(rows[vehicle], len(found.vehicles))
        label = baseline_label(vehicle)
        traces.append(_points(columns, drawn, found.parameter, place) | {"x": [label] * len(drawn)})
    if found.prior is not None:
        mean = float(found.prior.mean[0])
        spread = TWO_SIGMA * float(np.sqrt(found.prior.new_robot[0, 0]))
        labels = [baseline_label(vehicle) for vehicle in found.vehicles]
        ends = _physical(found.parameter, np.array((mean, mean - spread, mean + spread))).tolist()
        for value, dash in zip(ends, ("solid", "dot", "dot"), strict=True):
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
        traces.append(_points(columns, drawn, found.parameter, place) | {"x": days})
    layout = axis("day", type="date")
    return _figure("time", found, traces, layout)


def _figure(key: str, found: ParameterFindings, traces: list[dict[str, Any]], x: dict[str, Any]) -> Figure:
    unit, name = found.unit.removeprefix("ln "), physical_name(found.parameter)
    return Figure(
        key=f"{key}-{found.parameter}",
        label=f"{name} of every vehicle",
        heading=name,
        traces=traces,
        layout={"xaxis": x, "yaxis": axis(f"[{unit}]", small=True)},
        height=220,
    )


def _drawn(rows: NDArray[np.int64], vehicles: int) -> NDArray[np.int64]:
    """Return the rows of one vehicle and parameter that are drawn, evenly thinned where they are many."""
    return rows[thinned(len(rows), max(FEWEST_POINTS, CURVE_POINTS // vehicles))]


def _points(columns: Columns, rows: NDArray[np.int64], parameter: str, place: int) -> dict[str, Any]:
    value, std = columns["value"][rows].astype(float), columns["std"][rows].astype(float)
    shown, low, high = (_physical(parameter, value + times * std) for times in (0.0, -TWO_SIGMA, TWO_SIGMA))
    return {
        "type": "scatter",
        "mode": "markers",
        "y": numbers(shown),
        "error_y": {"type": "data", "array": numbers(high - shown), "arrayminus": numbers(shown - low)},
        "marker": {"color": COLOURS[place % len(COLOURS)]},
        "name": baseline_label(str(columns["vehicle"][rows[0]])),
    }


def _unusable(unusable: Sequence[Mapping[str, Any]]) -> str:
    if not unusable:
        return missing("All logs could be used.")
    rows = [
        (str(entry["log"]), str(entry["vehicle"]), str(entry["failure"])) for entry in unusable[:MOST_ROWS]
    ]
    more = "" if len(unusable) <= MOST_ROWS else missing(f"And {len(unusable) - MOST_ROWS} more.")
    return table(("log", "vehicle", "why"), rows) + more

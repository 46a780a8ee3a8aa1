# SPDX-License-Identifier: Apache-2.0
"""What stands out in a fleet: odd robots and parameters that drift, at a stated rate of false alarms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.fleet.correlated import Series, Walk, trends, walks
from slipwise.fleet.empirical_bayes import FleetPrior, fleet_prior
from slipwise.fleet.odd import Estimates, odd_ones

Floats = NDArray[np.float64]

FALSE_DISCOVERIES = 0.05  # of all alarms, over vehicles and parameters
#: Of the rate: a worn wheel shows little by little, a robot that is odd mostly by far.
WEIGHTS = {"drift": 3.0, "odd": 1.0}
STUDENT_DOF = 4.0  # of robots of a type, against one odd one
FEWEST_LOGS = 4  # of a vehicle, for its drift
TREND = 0.75  # weight of the trend's chance beside that of the random walk: most that wears, wears evenly
DAY = 86400.0  # s
FEWEST_OTHERS = 2  # vehicles that tell a course from what one of them does
_MOST_BINS = 12
_ROUNDS = 5


@dataclass(frozen=True)
class Finding:
    """One test of one vehicle and parameter."""

    vehicle: str
    parameter: str
    kind: str  # "odd" or "drift"
    size: float  # off the fleet's mean, or per 30 days; in the parameter's unit
    std: float
    chance: float  # p-value; of a drift, of its trend and its random walk together
    alarm: bool = False
    least: float = math.nan  # size from which on it would alarm alone, of an odd one
    walk: float = math.nan  # standard deviation of a random walk after a kilometre, of a drift
    now: float = math.nan  # the parameter after the last log by that walk, of a drift
    now_std: float = math.nan


@dataclass(frozen=True, eq=False)
class ParameterFindings:
    """One parameter over the fleet."""

    parameter: str
    unit: str
    vehicles: tuple[str, ...]
    estimate: Floats  # [V] of each vehicle, from its logs
    std: Floats  # [V] the scatter of its logs included
    prior: FleetPrior | None  # None for a single vehicle
    findings: tuple[Finding, ...]


def findings_of(table: Mapping[str, NDArray[Any]]) -> tuple[ParameterFindings, ...]:
    """Return what the rows of a fleet say, parameter by parameter; alarms are over all of them together.

    Args:
        table: columns of rows, as `Store.table` returns them.
    """
    if not table:
        return ()
    groups = rows_by_parameter(table)
    found = _with_odd([_parameter(table, name, groups[name]) for name in sorted(groups)])
    tests = [finding for each in found for finding in each.findings]
    weights = [WEIGHTS[finding.kind] for finding in tests]
    alarms = iter(discoveries([finding.chance for finding in tests], weights))
    return tuple(
        replace(each, findings=tuple(replace(finding, alarm=next(alarms)) for finding in each.findings))
        for each in found
    )


def rows_by_parameter(table: Mapping[str, NDArray[Any]]) -> dict[str, dict[str, NDArray[np.int64]]]:
    """Return the rows of each parameter and vehicle, both in order; each row is looked at once."""
    groups: dict[str, dict[str, list[int]]] = {}
    names, vehicles = table["parameter"].tolist(), table["vehicle"].tolist()
    for row, (name, vehicle) in enumerate(zip(names, vehicles, strict=True)):
        groups.setdefault(name, {}).setdefault(vehicle, []).append(row)
    return {
        name: {vehicle: np.array(of[vehicle]) for vehicle in sorted(of)}
        for name, of in sorted(groups.items())
    }


def discoveries(chances: Sequence[float], weights: Sequence[float] | None = None) -> list[bool]:
    """Return which tests are alarms at the false-discovery rate (Benjamini and Hochberg 1995).

    Args:
        chances: p-values.
        weights: how much of the rate each test is given, chosen without the data; only their ratios count
            (Genovese, Roeder and Wasserman 2006).
    """
    if not chances:
        return []
    given = np.ones(len(chances)) if weights is None else np.asarray(weights, dtype=np.float64)
    weighted = np.asarray(chances, dtype=np.float64) * np.mean(given) / given
    ordered = np.sort(weighted)
    limits = FALSE_DISCOVERIES * np.arange(1, len(ordered) + 1) / len(ordered)
    below = np.flatnonzero(ordered <= limits)
    largest = ordered[below[-1]] if len(below) else -1.0
    return [bool(chance <= largest) for chance in weighted]


def _parameter(
    table: Mapping[str, NDArray[Any]], name: str, rows: Mapping[str, NDArray[np.int64]]
) -> ParameterFindings:
    vehicles = list(rows)
    estimate, std = np.empty(len(vehicles)), np.empty(len(vehicles))
    series: dict[str, Series] = {}
    for place, (vehicle, mine) in enumerate(rows.items()):
        value, sigma = table["value"][mine].astype(float), table["std"][mine].astype(float)
        estimate[place], std[place] = pooled(value, sigma)
        if len(mine) >= FEWEST_LOGS:
            each = _series(table, mine)
            if np.ptp(each.days) > 0.0:
                series[vehicle] = each
    prior = (
        fleet_prior(estimate[:, None], std[:, None, None] ** 2, dof=STUDENT_DOF)
        if len(vehicles) > 1
        else None
    )
    drifts = _drifts(name, series)
    unit = str(table["unit"][min(int(mine[0]) for mine in rows.values())])
    return ParameterFindings(name, unit, tuple(vehicles), estimate, std, prior, tuple(drifts))


def pooled(values: Floats, stds: Floats) -> tuple[float, float]:
    """Return one vehicle's value and its standard deviation, from logs that may differ more than they say."""
    if len(values) == 1:
        return float(values[0]), float(stds[0])
    prior = fleet_prior(values[:, None], stds[:, None, None] ** 2)
    return float(prior.mean[0]), float(math.sqrt(prior.mean_covariance[0, 0]))


def _with_odd(found: Sequence[ParameterFindings]) -> list[ParameterFindings]:
    """Compare each vehicle with the others, in all parameters together; two cannot tell which is odd."""
    vehicles = sorted({vehicle for each in found for vehicle in each.vehicles})
    place = {vehicle: k for k, vehicle in enumerate(vehicles)}
    measured = []
    for each in found:
        estimate, std, weight = (np.full(len(vehicles), np.nan) for _ in range(3))
        at = [place[vehicle] for vehicle in each.vehicles]
        estimate[at], std[at] = each.estimate, each.std
        weight[at] = 1.0 if each.prior is None else each.prior.weight
        measured.append(Estimates(estimate, std, weight))
    compared, odd_ones_of = [], odd_ones(measured)
    kinds = [finding.kind for each in found for finding in each.findings]
    kinds += ["odd" for odd in odd_ones_of for _ in odd]
    alarming = FALSE_DISCOVERIES * WEIGHTS["odd"] / sum(WEIGHTS[kind] for kind in kinds) if kinds else 0.0
    for each, odd in zip(found, odd_ones_of, strict=True):
        mine = [
            Finding(vehicles[k], each.parameter, "odd", o.size, o.std, o.chance, least=o.least(alarming))
            for k, o in odd.items()
        ]
        compared.append(replace(each, findings=(*mine, *each.findings)))
    return compared


def _series(table: Mapping[str, NDArray[Any]], mine: NDArray[Any]) -> Series:
    """Return a vehicle's logs in the order of time."""
    order = mine[np.argsort(table["start"][mine], kind="stable")]
    driven = table["distance"][order].astype(float)
    return Series(
        days=table["start"][order].astype(float) / DAY,
        metres=np.cumsum(driven) - 0.5 * driven,
        values=table["value"][order].astype(float),
        stds=table["std"][order].astype(float),
    )


def _drifts(name: str, series: Mapping[str, Series]) -> list[Finding]:
    """Test the trend and the walk of each vehicle, less what all vehicles do alike."""
    left = dict(zip(series, without_common_course(list(series.values())), strict=True))
    walking = [vehicle for vehicle, each in left.items() if each.walks]
    walk_of = dict(zip(walking, walks([left[vehicle] for vehicle in walking]), strict=True))
    return [
        _with_walk(
            Finding(vehicle, name, "drift", 30.0 * t.slope, 30.0 * t.std, t.chance), walk_of.get(vehicle)
        )
        for vehicle, t in zip(left, trends(list(left.values())), strict=True)
    ]


def _with_walk(finding: Finding, walk: Walk | None) -> Finding:
    if walk is None:
        return finding
    return replace(
        finding,
        chance=_combined((finding.chance, walk.chance), (TREND, 1.0 - TREND)),
        walk=math.sqrt(1000.0 * walk.rate),
        now=walk.level,
        now_std=walk.level_std,
    )


def _combined(chances: Sequence[float], weights: Sequence[float]) -> float:
    """Return the chance of tests that may depend on each other, taken together (Liu and Xie 2020).

    A chance above 0.9 counts as 0.9: at the edge of what is possible it is 1 too often.
    """
    tangents = [math.tan((0.5 - min(chance, 0.9)) * math.pi) for chance in chances]
    return max(0.5 - math.atan(float(np.dot(weights, tangents))) / math.pi, 0.0)


def without_common_course(all_series: Sequence[Series]) -> list[Series]:
    """Return the series less what the others do alike.

    The course is the median of the other vehicles about their levels, in bins of time with straight lines
    between. It is shrunk by how much of it is the vehicles' own scatter, so that a fleet without one loses
    nothing; where too few others drove it is taken from the nearest times. What the others' logs say of
    themselves adds to what those of the vehicle say; their further scatter is found as if it were its own.
    """
    if len(all_series) <= FEWEST_OTHERS:  # wear of one looks like a season
        return list(all_series)
    edges = _edges(all_series)
    return [
        _less(series, [other for k, other in enumerate(all_series) if k != place], edges)
        for place, series in enumerate(all_series)
    ]


def _edges(all_series: Sequence[Series]) -> Floats:
    days = np.concatenate([series.days for series in all_series])
    count = int(np.clip(np.median([len(series.days) for series in all_series]), 2, _MOST_BINS))
    return np.linspace(days.min(), days.max() * (1.0 + 1e-12), count + 1)


def _less(series: Series, others: Sequence[Series], edges: Floats) -> Series:
    bins = [
        np.clip(np.searchsorted(edges, other.days, side="right") - 1, 0, len(edges) - 2) for other in others
    ]
    at = _places(np.concatenate([other.days for other in others]), np.concatenate(bins), edges)
    course = np.zeros(len(at))
    kept, lost = 0.0, 0.0
    for _ in range(_ROUNDS):
        binned = np.full((len(others), len(at)), np.nan)
        for row, other, places in zip(binned, others, bins, strict=True):
            left = other.values - np.interp(other.days, at, course)
            about = other.values - np.average(left, weights=other.stds**-2.0)
            drives = np.bincount(places, minlength=len(row))
            np.divide(np.bincount(places, about, len(row)), drives, out=row, where=drives > 0)
        counts = np.isfinite(binned).sum(axis=0)
        there = counts >= FEWEST_OTHERS
        if there.sum() < 2:
            return series
        median = _median(binned[:, there], counts[there])
        spread = np.nanvar(binned[:, there], axis=0, ddof=1)
        lost = float(np.mean(_of_median(counts[there])))
        noise = float(np.mean(_of_median(counts[there]) * spread))
        seen = float(np.var(median))
        kept = max(0.0, 1.0 - noise / seen) if seen > 0.0 else 0.0
        course = np.interp(at, at[there], median - median.mean())
    said = np.mean([np.mean(other.stds**2) * len(series.days) / len(other.days) for other in others])
    return replace(
        series,
        values=series.values - kept * np.interp(series.days, at, course),
        stds=np.sqrt(series.stds**2 + kept * lost * said),
    )


def _places(days: Floats, bins: NDArray[np.int64], edges: Floats) -> Floats:
    """Return the mean time of the logs in each bin, of one without logs its middle."""
    drives = np.bincount(bins, minlength=len(edges) - 1)
    places = 0.5 * (edges[1:] + edges[:-1])
    np.divide(np.bincount(bins, days, len(places)), drives, out=places, where=drives > 0)
    return places


def _of_median(counts: NDArray[np.int64]) -> Floats:
    """Return the variance of the median of so many normal numbers, within 2 %, in units of theirs."""
    return np.asarray(0.5 * np.pi / (counts + np.where(counts % 2 == 1, 0.5, 1.2)))


def _median(columns: Floats, counts: NDArray[np.int64]) -> Floats:
    """Return medians of columns, each of so many numbers; the rest of a column is NaN."""
    ordered, column = np.sort(columns, axis=0), np.arange(columns.shape[1])
    found: Floats = 0.5 * (ordered[(counts - 1) // 2, column] + ordered[counts // 2, column])
    return found

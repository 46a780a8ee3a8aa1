# SPDX-License-Identifier: Apache-2.0
"""What it costs to learn a surface and to add one example, measured."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.number_text import number_text
from slipwise_thesis import _thesis
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, MEASURED, Line, Panel, Points, Series
from slipwise_thesis.surfaces import (
    BayesianSurface,
    GaussianProcessOptions,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipExamples,
    UpdatableSurface,
    slip_examples,
)
from slipwise_thesis.thesis_figure import ThesisFigure

BASIS = _core.named_basis("odd-even-10")
SIZES = (100, 1_000, 10_000)
KINDS: dict[str, Callable[[], UpdatableSurface]] = {
    "least squares": lambda: LeastSquaresSurface(BASIS),
    "Gaussian process": lambda: GaussianProcessSurface(options=GaussianProcessOptions(largest=20_000)),
    "Bayesian": lambda: BayesianSurface(BASIS),
}


@dataclass(frozen=True)
class Cost:
    """Processor time of one size."""

    examples: int
    fit: float  # s
    add: float  # s, one more example
    measured: bool = True  # False: from a smaller one by N^3


def times_table(fixture: Fixture) -> ThesisFigure:
    """Make the table of times."""
    costs = {name: [cost(name, count, fixture) for count in SIZES] for name in KINDS}
    process, bayesian = costs["Gaussian process"][-1], costs["Bayesian"]
    largest = fixture.size.largest_process
    inflation = costs["Gaussian process"][1].add / max(costs["Gaussian process"][0].add, 1e-9)
    return ThesisFigure(
        key="table-5-times",
        thesis="Section 5.3.1",
        title="Time to fit, and to add one example",
        shows="Processor time, least squares and Bayesian regression with the ten terms of odd-even-10, for "
        "three channels together.",
        agrees="To add one example, the Gaussian process factors its matrix again: from 100 to 1 000 "
        f"examples that takes {inflation:.0f} times as long (1 000 times is the limit of O(N³)). Bayesian "
        f"regression takes {number_text(1e3 * bayesian[0].add, 2)} ms at 100 and "
        f"{number_text(1e3 * bayesian[-1].add, 2)} ms at 10 000 examples, where the Gaussian process takes "
        f"about {number_text(process.add, 2)} s.",
        differs="The thesis gives least squares O(N³) too; its cost is O(N d²), as measured. Adding to the "
        "Bayesian regression costs O(d²), not O(d³), since information is added and nothing is inverted. The "
        f"Gaussian process at 10 000 examples was not run: its time follows from {largest} by N³.",
        source="examples drawn from a known slip law",
        parts=(_grid(costs), _panel(costs)),
    )


def cost(name: str, count: int, fixture: Fixture) -> Cost:
    """Measure one surface at one size, or conclude from a smaller one."""
    largest = fixture.size.largest_process
    if name == "Gaussian process" and count > largest:
        small = _measured(name, largest, fixture.seed)
        factor = (count / largest) ** 3
        return Cost(count, factor * small.add, factor * small.add, measured=False)
    return _measured(name, count, fixture.seed)


def _measured(name: str, count: int, seed: int) -> Cost:
    surface, examples = KINDS[name](), draw(count + 1, seed)
    fit = _seconds(lambda: surface.fit(examples[:count]))
    return Cost(count, fit, _seconds(lambda: surface.update(examples[count:])))


def draw(count: int, seed: int) -> SlipExamples:
    """Draw segments of a skid-steered robot's slip law with noise."""
    random = np.random.Generator(np.random.PCG64(seed))
    drive = random.uniform((0.3, -1.0), (2.5, 1.0), (count, 2))
    alpha = np.array([-0.05, -0.02, -0.01, 0.03, -0.04, 0.01, -0.4, 0.05, 0.03, 0.01])
    rows = _thesis.feature_rows(BASIS, *(np.ascontiguousarray(column) for column in drive.T)) * alpha
    law = np.column_stack([rows[:, part].sum(axis=1) for part in (slice(0, 3), slice(3, 6), slice(6, 10))])
    return slip_examples(drive, law + 0.02 * random.standard_normal((count, 3)))


def _seconds(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def _grid(costs: dict[str, list[Cost]]) -> Grid:
    rows = []
    for name, row in costs.items():
        fits = [_time_text(c.fit, measured=c.measured) for c in row]
        adds = [_time_text(c.add, measured=c.measured) for c in row]
        rows.append((name, *fits, *adds))
    heads = [f"{what}, N = {size}" for what in ("fit", "add one") for size in SIZES]
    note = "Times depend on the machine and differ from run to run."
    return Grid("Processor time", ("surface", *heads), tuple(rows), note)


def _time_text(seconds: float, *, measured: bool) -> str:
    rounded = float(f"{seconds:.2g}")
    text = f"{number_text(rounded, 2)} s" if seconds >= 1.0 else f"{number_text(1e3 * rounded, 2)} ms"
    return text if measured else f"about {text}"


def _panel(costs: dict[str, list[Cost]]) -> Panel:
    series: list[Series] = []
    for (name, row), colour in zip(costs.items(), (FITTED, BASELINE, MEASURED), strict=True):
        size = np.array([float(c.examples) for c in row])
        add = np.array([1e3 * max(c.add, 1e-6) for c in row])
        series += [Line(size, add, name, colour), Points(size, add, colour=colour)]
    return Panel(
        "To add one example", "examples N", "processor time [ms]", tuple(series), log_x=True, log_y=True
    )

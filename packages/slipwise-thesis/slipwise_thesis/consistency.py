# SPDX-License-Identifier: Apache-2.0
"""Is the reported uncertainty true? NEES of every estimator over drives whose parameters are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from slipwise.number_text import number_text
from slipwise_thesis import _thesis
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.monte_carlo import (
    ESTIMATORS,
    NOISE,
    POSE_NOISE,
    Feeding,
    RunResult,
    judged,
    known_run,
    learned,
    nees_band,
)
from slipwise_thesis.panel import INK, Dash, Line, Panel
from slipwise_thesis.thesis_figure import ThesisFigure

Floats = NDArray[np.float64]
Results = dict[str, list[RunResult]]  # by the label of the feeding

BASIS, SIZE = "odd-even-10", 10
MINUTES = 3.0
THESIS_FILTER = Feeding("ekf-thesis", 1, _thesis.SegmentJacobian.Thesis)
NOISES = {"slip and pose noise": NOISE, "mostly pose noise": POSE_NOISE}


def consistency_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the table of all estimators."""
    runs = fixture.size.seeds
    found: dict[str, Results] = {name: {} for name in NOISES}
    for done in range(runs * len(NOISES)):
        name, seed = list(NOISES)[done // runs], done % runs
        progress(f"{name}, drive {seed + 1} of {runs}", done / (runs * len(NOISES)))
        drive = known_run(BASIS, seed, NOISES[name], minutes=MINUTES)
        for feeding in ESTIMATORS:
            result = judged(learned(feeding, drive), drive)
            found[name].setdefault(feeding.label, []).append(result)
    return [_figure(found, runs)]


def _figure(found: dict[str, Results], runs: int) -> ThesisFigure:
    band = nees_band(runs, SIZE)
    return ThesisFigure(
        "consistency",
        "Not in the thesis",
        "Is the reported uncertainty true?",
        f"Each estimator learns {runs} drives of {MINUTES:g} minutes whose {SIZE} slip parameters were drawn "
        "from the prior. NEES is the squared error of all parameters in units of that covariance, over "
        "their number m: 1 on average where the covariance is true, and for so many drives between "
        f"{band[0]:.2f} and {band[1]:.2f} with 95 %.",
        " ".join(_errors(name, results) for name, results in found.items()),
        " ".join(_verdict(name, results, band) for name, results in found.items())
        + " The thesis says that its filter handles the uncertainty correctly. But fed 20 times a second "
        "with windows of 5 s, it counts each datum about a hundred times. Gradient descent has no "
        "covariance; that of the prior is judged.",
        "simulated step by step from known slip, white slip noise and pose noise; "
        f"seeds 0 to {runs - 1}, the same for all estimators",
        (*(_panel(name, results) for name, results in found.items()), _table(found, band)),
    )


def _mean(results: list[RunResult]) -> float:
    return float(np.mean([result.nees for result in results]))


def _errors(name: str, results: Results) -> str:
    """How well the thesis's two estimators find the parameters, beside the best."""
    errors = {label: float(np.mean([run.error for run in runs])) for label, runs in results.items()}
    best = min(errors, key=lambda label: errors[label])
    labels = [Feeding("gradient-descent", 1).label, THESIS_FILTER.label, best]
    said = ", ".join(f"{label}: {100 * errors[label]:.0f} %" for label in dict.fromkeys(labels))
    return f"With {name}, the parameters' error after the drive, as a part of the prior's: {said}."


def _verdict(name: str, results: Results, band: tuple[float, float]) -> str:
    outside = [
        f"{label} ({number_text(_mean(runs))})"
        for label, runs in results.items()
        if not band[0] <= _mean(runs) <= band[1]
    ]
    return f"With {name}, outside the band: {'; '.join(outside) or 'none'}."


def _table(found: dict[str, Results], band: tuple[float, float]) -> Grid:
    rows = []
    for name, results in found.items():
        for label, runs in results.items():
            mean = _mean(runs)
            place = "below" if mean < band[0] else "above" if mean > band[1] else "inside"
            rows.append(
                (
                    label,
                    name,
                    number_text(mean),
                    f"{band[0]:.3f} to {band[1]:.3f}",
                    place,
                    f"{100 * np.mean([run.within_sigma for run in runs]):.0f} %",
                    f"{100 * np.mean([run.in_region_90 for run in runs]):.0f} %",
                    f"{100 * np.mean([run.error for run in runs]):.0f} %",
                )
            )
    columns = (
        *("estimator, windows", "noise", "NEES/m", "95 % band", "place", "within 1 sigma (68 %)"),
        *("in 90 % region", "error / prior"),
    )
    return Grid(
        "Mean over the drives",
        columns,
        tuple(rows),
        "Above the band: surer than right. Below: less sure than right. 20 Hz: a window begins every 0.05 s. "
        "Shared poses: each window begins with the pose that the last one ended with. (6.7): with the "
        "thesis's Jacobian.",
    )


def _panel(name: str, results: Results) -> Panel:
    dashes: tuple[Dash, ...] = ("solid", "dash", "dot", "dashdot")
    lines = [
        Line(np.sort([run.nees for run in runs]), _steps(len(runs)), label, dash=dashes[k % len(dashes)])
        for k, (label, runs) in enumerate(results.items())
    ]
    count = max(len(runs) for runs in results.values())
    lines.append(Line(_chi_square_quantiles(count) / SIZE, _steps(count), "if true", INK, width=2.6))
    return Panel(
        f"Drives with {name}", "NEES/m [1]", "fraction of drives below [1]", tuple(lines), log_x=True
    )


def _steps(count: int) -> Floats:
    return (np.arange(count) + 0.5) / count


def _chi_square_quantiles(count: int) -> Floats:
    """Quantiles of chi-square with `SIZE` degrees at `_steps(count)` (Wilson-Hilferty)."""
    from statistics import NormalDist

    z = np.array([NormalDist().inv_cdf(fraction) for fraction in _steps(count).tolist()])
    spread = 2.0 / (9.0 * SIZE)
    return np.asarray(SIZE * (1.0 - spread + z * np.sqrt(spread)) ** 3, dtype=np.float64)

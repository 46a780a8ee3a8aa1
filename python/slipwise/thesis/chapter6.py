# SPDX-License-Identifier: Apache-2.0
"""Chapter 6: learning on-line, in transients."""

from __future__ import annotations

from collections.abc import Callable

from slipwise.thesis.bench import Bench
from slipwise.thesis.chapter6_circling import circling
from slipwise.thesis.chapter6_convergence import descent_exhibit, filter_exhibit, residual_exhibit
from slipwise.thesis.chapter6_drives import SimplePath, path_exhibit, perturbation_exhibit
from slipwise.thesis.chapter6_jacobian import jacobian_exhibit
from slipwise.thesis.chapter6_recording import Course, record
from slipwise.thesis.chapter6_smoothing import smoothing_exhibit
from slipwise.thesis.chapter6_table import table_exhibit
from slipwise.thesis.chapter6_uncertainty import correlation_exhibit, learned_surface_exhibit
from slipwise.thesis.exhibit import Exhibit

GROUND = "tyre-force"


def chapter6_exhibits(bench: Bench, progress: Callable[[str, float], None]) -> list[Exhibit]:
    """Make the exhibits of on-line learning."""
    progress("perturbative simulator", 0.0)
    path = SimplePath(bench)
    exhibits = [path_exhibit(path), perturbation_exhibit(path)]
    progress("estimators of the thesis", 0.35)
    exhibits += _courses(bench)
    for share, ground in ((0.6, "tyre-force"), (0.8, "contact-friction")):
        progress(f"Table 6.2 on {ground} ground", share)
        exhibits.append(table_exhibit(bench, ground))
    return exhibits


def _courses(bench: Bench) -> list[Exhibit]:
    """Figures 6.3 to 6.7, with the terms of (6.10) from wheel speeds."""
    log = circling(bench, GROUND)
    source = (
        f"simulated Land Tamer on {GROUND} ground, {bench.size.long_time:g} s of circles at various "
        "speeds and curvatures from zero, wheel speeds as input"
    )
    descent, filtered, correct = (
        record(log, Course(name)) for name in ("gradient-descent", "ekf-thesis", "iekf")
    )
    return [
        residual_exhibit(descent, source),
        descent_exhibit(descent, source),
        smoothing_exhibit(bench.seed, bench.size.long_time),
        filter_exhibit(filtered, descent, source),
        jacobian_exhibit(filtered, log, source),
        correlation_exhibit(filtered, correct, source),
        learned_surface_exhibit(filtered, correct, source),
    ]

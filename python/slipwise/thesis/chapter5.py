# SPDX-License-Identifier: Apache-2.0
"""Chapter 5: slip surfaces over speed and curvature."""

from __future__ import annotations

from collections.abc import Callable

from slipwise.thesis.bench import Bench
from slipwise.thesis.chapter5_scores import score_exhibit
from slipwise.thesis.chapter5_spread import spread_exhibit
from slipwise.thesis.chapter5_surfaces import REGRESSIONS, other_ground_exhibit, surface_exhibit
from slipwise.thesis.chapter5_times import times_exhibit
from slipwise.thesis.exhibit import Exhibit


def chapter5_exhibits(bench: Bench, progress: Callable[[str, float], None]) -> list[Exhibit]:
    """Make the exhibits of the slip surfaces."""
    exhibits = []
    for share, regression in zip((0.0, 0.4, 0.45), REGRESSIONS, strict=True):
        progress(f"surfaces by {regression.title}", share)
        exhibits.append(surface_exhibit(bench, regression))
    progress("contact-friction ground", 0.5)
    exhibits.append(other_ground_exhibit(bench))
    progress("held-out scores", 0.8)
    exhibits.append(score_exhibit(bench))
    exhibits.insert(1, spread_exhibit(bench))
    progress("times", 0.9)
    return [*exhibits, times_exhibit(bench)]

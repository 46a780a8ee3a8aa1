# SPDX-License-Identifier: Apache-2.0
"""Whether predicted distributions are true: coverage over logs, and mean NIS beside chance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.predictions import Predictions

if TYPE_CHECKING:
    from log_score import LogScore, MethodScore

Floats = NDArray[np.float64]

NIS_RANGE = (2.5, 3.5)  # of the mean NIS of a log; 3 is true
MANY_WINDOWS = 50  # held out
_DRAWS, _SEED = 500, 3
_CHI_SQUARE = np.linspace(0.0, 60.0, 6001)
_CHI_SQUARE_FRACTION = np.array(
    [math.erf(math.sqrt(x / 2)) - math.sqrt(2 * x / math.pi) * math.exp(-x / 2) for x in _CHI_SQUARE]
)


def normal_score(inside: Floats) -> float:
    """Mean NIS once each error is stretched to a normal one by its predicted t; 3 where the t is true."""
    return float(np.interp(inside, _CHI_SQUARE_FRACTION, _CHI_SQUARE).mean())


def chance_of_range(predictions: Predictions, half: slice) -> float:
    """Chance that the mean NIS lies in `NIS_RANGE` where every predicted t is true, by seeded draws."""
    rng, dof = np.random.default_rng(_SEED), predictions.dof[half]
    size = (_DRAWS, len(dof))
    means = (rng.chisquare(3.0, size) * (dof - 2.0) / rng.chisquare(dof, size)).mean(axis=1)
    return float(np.mean((means >= NIS_RANGE[0]) & (means <= NIS_RANGE[1])))


def normal_chance_of_range(windows: int) -> float:
    """The same for normal errors: the mean NIS has a standard deviation of sqrt(6 / windows)."""
    return math.erf((NIS_RANGE[1] - 3.0) / math.sqrt(6.0 / windows) / math.sqrt(2.0))


def print_coverage(scores: Sequence[LogScore], methods: Sequence[str]) -> None:
    """Print coverage over all held-out windows of all logs, and how often the mean NIS is in range."""
    print(
        f"{'':16}         inside the 50/90/95 % ellipsoids [%]    logs with mean NIS in 2.5-3.5 [%]\n"
        f"{'method':16}windows   predicted t      usual covariance    predicted t  usual covariance"
    )
    for method in methods:
        having = [s.methods[method] for s in scores if method in s.methods]
        predicted, usual = (
            "/".join(f"{100 * fraction:.1f}" for fraction in pooled(having, name))
            for name in ("coverage", "reported_coverage")
        )
        print(
            f"{method:16}{sum(m.windows for m in having):7}   {predicted:16} {usual:16}"
            f"{_share([m.nis for m in having]):>12} {_share([m.reported_nis for m in having]):>17}"
        )


def print_chances(scores: Sequence[LogScore]) -> None:
    """Print on how many logs the mean NIS of `auto` is in range, beside what a perfect filter would have."""
    many = [s for s in scores if s.windows >= MANY_WINDOWS]
    groups = {"all logs": scores, f"logs with at least {MANY_WINDOWS} held-out windows": many}
    for name, group in groups.items():
        autos = [s.methods["auto"] for s in group]
        if not autos:
            continue
        normal = 100 * np.mean([normal_chance_of_range(m.windows) for m in autos])
        heavy = 100 * np.mean([m.nis_chance for m in autos])
        print(
            f"auto, {name} ({len(autos)}): mean NIS in 2.5-3.5 on {_share([m.nis for m in autos])} %\n"
            f"  a perfect filter: {normal:.0f} % with normal errors, {heavy:.0f} % with the predicted t\n"
            f"  mean NIS of errors stretched to normal ones by their t in 2.5-3.5 on "
            f"{_share([m.normal_nis for m in autos])} %"
        )


def pooled(methods: Sequence[MethodScore], name: str) -> tuple[float, float, float]:
    """Return a coverage over all windows of several logs."""
    windows = [m.windows for m in methods]
    half, nine_tenths, most = np.average(
        [getattr(m, name) for m in methods], axis=0, weights=windows
    ).tolist()
    return half, nine_tenths, most


def _share(values: Sequence[float]) -> str:
    if not values:
        return "-"
    return f"{100 * np.mean([NIS_RANGE[0] <= value <= NIS_RANGE[1] for value in values]):.0f}"

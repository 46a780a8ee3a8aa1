# SPDX-License-Identifier: Apache-2.0
"""How much each tuning constant matters: times 2 and times 1/2 over real logs, from commands and from wheels.

Varied are the numbers of the settings, those of the core's settings, and the constants of the sources that
SLIPWISE_TUNING declares, for which a build of its own is made in build/sensitivity. Of a fraction of a whole
the odds are varied. Printed are relative changes of the geometric means over logs of the held-out position
and heading errors, largest first. What changes neither by 0.2 % either way could be no constant.

By default the logs are a few of every data set; --all takes every log.

    python benchmarks/sensitivity.py --only f1tenth/DS4 --constant weighting --json sensitivity.json
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from data_sets import FEW, data_sets, required_folder
from replay_score import ReplayScore, mean_replay
from tuning_constants import build_tuned_core, tuning_constants
from variants import Variant, of_input, scored_variants

from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import Settings
from slipwise.cli.output import Column, Output

FACTORS = (2.0, 0.5)
INPUTS = ("command", "wheel")
NEGLIGIBLE, NEGLIGIBLE_COVERAGE = 0.2, 0.5  # %, points of %
#: Fractions of a whole, and quantiles: of these, the odds are varied.
FRACTIONS = frozenset(
    {
        "disturbance.white",
        "hypotheses.average.largest_basis",
        "driven_speeds.kReferenceFraction",
        "causal_filter.kExpected",
        "score_covariance.kMostTaken",
    }
)
#: Of the core's settings, what is no tuning: numerical limits, promises, what is not learned here.
NO_TUNING = frozenset(
    {
        "iterations",
        "tolerance",
        "halvings",
        "latency",
        "horizons",
        "extrinsics_std",
        "sensor_yaw_std",
        "unknown_after",
    }
)
HEADS = ("cmd pos", "cmd head", "whl pos", "whl head", "cov")


@dataclass(frozen=True)
class Change:
    """What a factor of a constant changes."""

    errors: tuple[float, float, float, float]  # %: position and heading from commands, then from wheels
    coverage: float  # largest, of the 50/90/95 % ellipsoids from either input [points of %]

    @property
    def largest(self) -> float:
        """The largest change of an error [%]."""
        return max((abs(value) for value in self.errors if math.isfinite(value)), default=0.0)


@dataclass(frozen=True)
class Varied:
    """A constant, and what its factors change; None where the learner refuses the value."""

    name: str
    value: str
    changes: tuple[Change | None, ...]

    @property
    def largest(self) -> float:
        """The largest change of an error by any factor [%]."""
        return max((change.largest for change in self.changes if change), default=0.0)

    @property
    def matters(self) -> bool:
        """Whether anything changes by enough to see."""
        points = max((change.coverage for change in self.changes if change), default=0.0)
        return self.largest >= NEGLIGIBLE or points >= NEGLIGIBLE_COVERAGE


@dataclass(frozen=True)
class Constant:
    """Something that can be varied."""

    name: str
    value: str

    def variant(self, factor: float) -> Variant:
        """Return the variant in which it is multiplied."""
        label = f"{self.name} x {factor:g}"
        factor = _odds_factor(float(self.value), factor) if self.name in FRACTIONS else factor
        if ".k" in self.name:
            return Variant(label, constants={self.name: factor})
        return Variant(label, numbers={self.name: factor})


def _odds_factor(fraction: float, factor: float) -> float:
    return factor / (1.0 - fraction + fraction * factor)


def constants() -> list[Constant]:
    """Return all that can be varied: settings, the core's settings, constants of the sources."""
    core = core_settings(Settings(), "command", (5.0,))
    return [
        *(Constant(path, _text(value)) for path, value in numbers(core)),
        *(Constant(each.name, each.value) for each in tuning_constants()),
    ]


def numbers(settings: object, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the path and value of every number, or list of numbers, of the core's settings."""
    for name in (name for name in dir(settings) if not name.startswith("_") and name not in NO_TUNING):
        value = getattr(settings, name)
        if type(value).__module__ == _core.__name__ and type(value) is not _core.Pose2:
            yield from numbers(value, f"{path}{name}.")
        elif _is_number(value) or (isinstance(value, list) and value and all(map(_is_number, value))):
            yield path + name, value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value > 0


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def change_of(scores: Sequence[ReplayScore], default: Sequence[ReplayScore]) -> Change:
    """Return what a variant changes."""
    errors, points = [math.nan] * 4, [0.0]
    for k, name in enumerate(INPUTS):
        mean, before = mean_replay(of_input(scores, name)), mean_replay(of_input(default, name))
        if mean is not None and before is not None:
            errors[2 * k] = 100.0 * (mean.position / before.position - 1.0)
            errors[2 * k + 1] = 100.0 * (mean.heading / before.heading - 1.0)
            points += [100.0 * abs(a - b) for a, b in zip(mean.inside, before.inside, strict=True)]
    return Change((errors[0], errors[1], errors[2], errors[3]), max(points))


def vary(chosen: Sequence[Constant], logs: Sequence[str], core: Path, workers: int) -> Iterator[Varied]:
    """Vary each constant by each factor."""
    variants = [constant.variant(factor) for constant in chosen for factor in FACTORS]
    found = scored_variants([Variant(), *variants], logs, core=core, workers=workers)
    default = next(found)
    if not default:
        raise SystemExit("no log of that name has enough held-out segments")
    for constant in chosen:
        rows = [next(found) for _ in FACTORS]
        changes = tuple(None if scores is None else change_of(scores, default) for scores in rows)
        yield Varied(constant.name, constant.value, changes)


def by_effect(varied: Iterable[Varied]) -> list[Varied]:
    """Sort by the largest change of an error."""
    return sorted(varied, key=lambda each: -each.largest)


def show(output: Output, varied: Sequence[Varied]) -> None:
    """Print the table, and what does not matter."""
    columns = (
        Column("constant", whole=True),
        Column("value", True),
        *(Column(f"{head} x{factor:g}", True) for factor in FACTORS for head in HEADS),
    )
    rows = [
        (
            v.name.removeprefix("hypotheses."),
            v.value,
            *(text for change in v.changes for text in _cells(change)),
        )
        for v in varied
    ]
    caption = "-: the learner refuses the value. cov: largest change of coverage [points of %]."
    output.table("Change of mean errors [%]", columns, rows, caption=caption)
    little = [each.name for each in varied if not each.matters]
    output.line(
        f"Change no error by {NEGLIGIBLE:g} %, and no coverage by {NEGLIGIBLE_COVERAGE:g} points, either way "
        f"({len(little)} of {len(varied)}):"
    )
    for name in little:
        output.line(f"  {name}")


def _cells(change: Change | None) -> list[str]:
    if change is None:
        return ["-"] * len(HEADS)
    errors = [f"{value:+.1f}" if math.isfinite(value) else "" for value in change.errors]
    return [*errors, f"{change.coverage:.1f}"]


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    parser.add_argument("--all", action="store_true", help="every log, not a few of every data set")
    parser.add_argument("--constant", default="", help="only constants whose name contains this")
    parser.add_argument("--list", action="store_true", help="list the constants, and vary none")
    parser.add_argument("--workers", type=int, default=2, help="processes at a time")
    arguments = parser.parse_args()
    chosen = [each for each in constants() if arguments.constant in each.name]
    if arguments.list:
        print("\n".join(f"{each.name:50} {each.value}" for each in chosen))
        return 0
    folder = required_folder()
    every = arguments.all or arguments.only
    logs = [d.name for d in data_sets(folder) if arguments.only in d.name and (every or d.name in FEW)]
    output, done = Output(arguments.json), []
    for varied in vary(chosen, logs, build_tuned_core(), arguments.workers):
        done = by_effect([*done, varied])
        output.document({"logs": logs, "factors": FACTORS, "constants": [asdict(each) for each in done]})
    show(output, done)
    return 0


if __name__ == "__main__":
    sys.exit(main())

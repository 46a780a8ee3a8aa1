# SPDX-License-Identifier: Apache-2.0
"""Tables of the score on real logs: per log, over all logs, and beside the reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from log_score import LogScore, best_basis_mean, mean_score
from reference import Comparison

WIDTH = 37  # of a log's name


@dataclass(frozen=True)
class Target:
    """What `auto` is to reach over all logs, relative to the kinematic baseline."""

    position: float
    heading: float
    worst: float  # on every log


def print_logs(scores: Sequence[LogScore]) -> None:
    """Print one line per log: the kinematic baseline's errors, and `auto` beside the best fixed basis."""
    print(
        f"{'':{WIDTH}} held  mean error of none   auto / none, 95 % interval"
        f"{'':32}best fixed basis, chosen afterwards     in ellipsoid [%]\n"
        f"{'log':{WIDTH}}  out       m      rad   {'position':21}{'heading':21}"
        f"{'position':20}{'heading':20}   NIS   50  90  95"
    )
    for s in scores:
        none, auto = s.methods["none"], s.methods["auto"]
        print(
            f"{s.log:{WIDTH}}{s.windows:5}{' ' if s.counts else '!'}"
            f"{none.position:7.3f} {none.heading:8.3f}   "
            f"{_interval(auto.position_ratio)}   {_interval(auto.heading_ratio)}   "
            f"{_best(s, 'position')} {_best(s, 'heading')}{auto.nis:6.2f} "
            + "".join(f"{100 * fraction:4.0f}" for fraction in auto.coverage)
        )


def print_ratios(scores: Sequence[LogScore]) -> None:
    """Print every method's ratios on every log, position / heading."""
    methods = method_names(scores)[1:]
    print(f"{'log':{WIDTH}}" + "".join(f"{m[:13]:>14}" for m in methods))
    for s in scores:
        print(f"{s.log:{WIDTH}}" + "".join(f"{_ratios(s, m):>14}" for m in methods))


def print_means(scores: Sequence[LogScore], target: Target) -> None:
    """Print the score of every method and whether `auto` reaches the target."""
    print(f"{'method':16}logs  position  heading   worst log, position{'':{WIDTH - 12}}worst log, heading")
    for method in method_names(scores):
        mean = mean_score(scores, method)
        if mean is None:
            continue
        causal = all(s.methods[method].causal for s in scores if method in s.methods)
        print(
            f"{method:16}{mean.logs:4}  {mean.position:8.3f} {mean.heading:8.3f}   "
            f"{mean.worst_position:6.2f} {mean.worst_position_log:{WIDTH}}"
            f"{mean.worst_heading:6.2f} {mean.worst_heading_log}{'' if causal else '  (not causal)'}"
        )
    position, heading = best_basis_mean(scores)
    print(
        f"{'best of each log':16}      {position:8.3f} {heading:8.3f}"
        "   (the best fixed basis, chosen afterwards)"
    )
    auto = mean_score(scores, "auto")
    if auto is not None:
        print(
            f"Target of auto: position {_verdict(auto.position, target.position)}, "
            f"heading {_verdict(auto.heading, target.heading)}, "
            f"worst log {_verdict(max(auto.worst_position, auto.worst_heading), target.worst)}"
        )


def print_few(scores: Sequence[LogScore]) -> None:
    """Name the logs that are too short to count."""
    few = [f"{s.log} ({s.windows})" for s in scores if not s.counts]
    if few:
        print("Left out of the means for too few held-out windows, marked !: " + ", ".join(few))


def print_comparison(comparisons: Sequence[Comparison], missing: Sequence[str]) -> None:
    """Print absolute errors beside the reference's best basis of each log, chosen afterwards."""
    print(
        f"{'':{WIDTH}}         windows    position [m]{'':16}heading [rad]\n"
        f"{'log':{WIDTH}}input     ours  its     auto    its best{'':15}auto    its best"
    )
    for c in comparisons:
        words = [word for word, bad in zip(("position", "heading"), c.worse, strict=True) if bad]
        marks = f"worse: {', '.join(words)}" if words else ""
        print(
            f"{c.log:{WIDTH}}{c.input:8}{c.windows:6}{c.reference_windows:5} "
            f"{c.auto[0]:8.3f} {c.reference_best[0]:8.3f} {c.best[0]:14}"
            f"{c.auto[1]:8.3f} {c.reference_best[1]:8.3f} {c.best[1]:14}{marks}"
        )
    worse = [sum(c.worse[k] for c in comparisons) for k in (0, 1)]
    print(f"Worse in position on {worse[0]}, in heading on {worse[1]} of {len(comparisons)}.")
    if missing:
        print("The reference has no figures for: " + ", ".join(missing))


def print_window_differences(comparisons: Sequence[Comparison]) -> None:
    """Say where the reference scored other windows: there the kinematic baseline is not equally wrong."""
    print(
        f"{'':{WIDTH}}         error of none, ours / its{'':10}"
        "relative to its own none, auto / its best basis"
    )
    for c in (c for c in comparisons if not c.same_windows):
        relative = [
            f"{_quotient(c.auto[k], c.none[k])} / {_quotient(c.reference_best[k], c.reference_none[k])}"
            for k in (0, 1)
        ]
        print(
            f"{c.log:{WIDTH}}{c.input:8} {c.none[0]:6.3f} / {c.reference_none[0]:.3f} m, "
            f"{c.none[1]:.3f} / {c.reference_none[1]:.3f} rad   position {relative[0]}, heading {relative[1]}"
        )


def method_names(scores: Sequence[LogScore]) -> list[str]:
    """Return all methods, in the order of the evaluation that has most of them."""
    return max((list(s.methods) for s in scores), key=len, default=[])


def _interval(value: tuple[float, float, float]) -> str:
    return f"{value[0]:5.2f} [{value[1]:.2f}, {value[2]:.2f}]"


def _best(score: LogScore, error: str) -> str:
    name = score.best_basis(error)
    method = score.methods[name]
    value = method.position_ratio[0] if error == "position" else method.heading_ratio[0]
    return f"{value:5.2f} {name:13}"


def _ratios(score: LogScore, method: str) -> str:
    if method not in score.methods:
        return "-"
    result = score.methods[method]
    return f"{result.position_ratio[0]:.2f} / {result.heading_ratio[0]:.2f}"


def _quotient(error: float, plain: float) -> str:
    return f"{error / plain:.2f}" if plain > 0.0 else "-"


def _verdict(value: float, limit: float) -> str:
    return f"{value:.3f} (limit {limit}: {'reached' if value <= limit else 'MISSED'})"

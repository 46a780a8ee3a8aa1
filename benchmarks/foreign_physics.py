# SPDX-License-Identifier: Apache-2.0
"""`auto` beside simple methods on logs from engines whose physics is not ours, regime by regime.

    pip install -r benchmarks/requirements-foreign.txt
    python benchmarks/foreign_physics.py --json foreign.json

It drives Bullet's Husky and a 1:10 car of slipx (`foreign_engines`), or reads the logs of a folder whose
files are named as theirs (`--logs`). Errors are those at 5 s of the held-out half, over those of the
kinematic baseline.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from data_sets import LONG_HORIZON, DataSet
from foreign_engines import Car, Husky, write_drive
from log_score import geometric_mean
from replay_score import ReplayScore, replay_score

import slipwise
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import make_settings

SIMPLE = ("edd-2", "odd-even-10", "drive-5")
INPUTS = ("wheel", "command")
WANTED_POOLED, WANTED_WORST = 1.05, 1.25  # of the best simple method
DRIVES: dict[str, Husky | Car] = {
    "husky": Husky(),
    "husky_lag": Husky(lag=0.2),
    "husky_lag_0.4": Husky(lag=0.4),
    "husky_payload": Husky(lag=0.1, payload=60.0, torque=48.0),
    "husky_payload_30": Husky(lag=0.1, payload=30.0, torque=40.0),
    "husky_weak_motors": Husky(payload=40.0, torque=27.0),
    "husky_friction": Husky(lag=0.1, friction_later=0.3),
    "car_1.0": Car(1.0),
    "car_2.0": Car(2.0),
    "car_3.5": Car(3.5),
    "car_5.0": Car(5.0),
    "car_5.0_heavy": Car(5.0, mass=5.0),
    "car_friction": Car(3.0, grip_later=0.75),
}


@dataclass(frozen=True)
class ForeignScore:
    """One log from one input: errors over the baseline's, and what `auto` is over the best simple method."""

    engine: str
    regime: str
    log: str
    input: str
    position: dict[str, float]  # by method
    heading: dict[str, float]
    windows: int
    inside: tuple[float, float, float]  # the 50, 90, 95 % ellipsoids of `auto`

    def over_best(self) -> tuple[float, float]:
        """Return what `auto` is over the best simple method, in position and in heading."""
        position, heading = (
            errors["auto"] / min(errors[name] for name in SIMPLE) for errors in (self.position, self.heading)
        )
        return position, heading


def made_logs(folder: Path, seeds: int, minutes: float, first_seed: int) -> Iterator[tuple[str, Path]]:
    """Drive each regime; yields its name and the log."""
    for place, (regime, drive) in enumerate(DRIVES.items()):
        for k in range(seeds):
            seed = first_seed + 100 * place + k
            path = folder / f"{regime}_seed{seed}_{minutes:g}min.csv"
            yield regime, path if path.exists() else write_drive(drive, path, seed=seed, minutes=minutes)


def given_logs(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the logs below a folder, each a regime of its own."""
    for path in sorted(folder.rglob("*.csv.gz")):
        yield path.name.removesuffix(".csv.gz"), path


def score_log(regime: str, path: Path, input_name: str) -> ForeignScore | None:
    """Score all methods; None where too few windows are held out, or the log is refused."""
    data = DataSet(path.name, path, LONG_HORIZON, None)
    scores: dict[str, ReplayScore] = {}
    for method in ("auto", *SIMPLE):
        try:
            log = slipwise.open_log(path)
            core = core_settings(make_settings({"basis": method}), input_name, (LONG_HORIZON,))
        except slipwise.SlipwiseError as problem:
            print(f"{path.name}: left out: {problem}")
            return None
        score = replay_score(data, log, core, limits=False)
        if score is None:
            return None
        scores[method] = score
    return ForeignScore(
        engine="Bullet" if regime.startswith("husky") else "slipx",
        regime=regime,
        log=path.name,
        input=input_name,
        position={name: score.position for name, score in scores.items()},
        heading={name: score.heading for name, score in scores.items()},
        windows=scores["auto"].windows,
        inside=scores["auto"].inside,
    )


def pooled(scores: Sequence[ForeignScore]) -> ForeignScore:
    """Return the geometric means of some logs, their coverage by windows."""
    windows = [score.windows for score in scores]
    half, nine_tenths, most = np.average([score.inside for score in scores], axis=0, weights=windows).tolist()
    means = {
        name: {m: geometric_mean([getattr(s, name)[m] for s in scores]) for m in ("auto", *SIMPLE)}
        for name in ("position", "heading")
    }
    return replace(
        scores[0],
        log=f"{len(scores)} logs",
        position=means["position"],
        heading=means["heading"],
        windows=sum(windows),
        inside=(half, nine_tenths, most),
    )


def markdown(scores: Sequence[ForeignScore]) -> Iterator[str]:
    """Yield a table for each input, one row a regime, and the coverage of each engine."""
    for name in INPUTS:
        of_input = [score for score in scores if score.input == name]
        if not of_input:
            continue
        yield f"| {name}s | auto | {' | '.join(SIMPLE)} | auto over the best | worst log |"
        yield "|---|---|---|---|---|---|---|"
        for regime in dict.fromkeys(score.regime for score in of_input):
            logs = [score for score in of_input if score.regime == regime]
            yield _row(f"{regime}, {len(logs)}", pooled(logs), logs)
        yield _row(f"all, {len(of_input)}", pooled(of_input), of_input)
        for engine in dict.fromkeys(score.engine for score in of_input):
            inside = pooled([score for score in of_input if score.engine == engine]).inside
            yield f"\n{engine}, {name}s: {_percent(inside)} % within the 50 / 90 / 95 % ellipsoids\n"


def _row(title: str, mean: ForeignScore, logs: Sequence[ForeignScore]) -> str:
    errors = [f"{mean.position[m]:.3f} / {mean.heading[m]:.3f}" for m in ("auto", *SIMPLE)]
    position, heading = mean.over_best()
    worst = np.max([score.over_best() for score in logs], axis=0)
    missed = max(position, heading) > WANTED_POOLED or float(worst.max()) > WANTED_WORST
    over = f"{position:.2f} / {heading:.2f}{' (missed)' if missed else ''}"
    return f"| {title} | {' | '.join(errors)} | {over} | {worst[0]:.2f} / {worst[1]:.2f} |"


def _percent(inside: tuple[float, float, float]) -> str:
    return " / ".join(f"{100.0 * each:.0f}" for each in inside)


def main() -> int:
    """Score, print the tables, and keep the raw numbers where asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--logs", type=Path, help="a folder of logs of these engines, in place of new drives")
    parser.add_argument("--seeds", type=int, default=2, help="drives of each regime (2)")
    parser.add_argument("--first-seed", type=int, default=1000, help="of the drives (1000)")
    parser.add_argument("--minutes", type=float, default=5.0, help="of each drive (5)")
    parser.add_argument("--keep", type=Path, help="where the drives are kept, and read again")
    parser.add_argument("--json", type=Path, help="where the scores go")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        made = made_logs(folder, asked.seeds, asked.minutes, asked.first_seed)
        logs = given_logs(asked.logs) if asked.logs else made
        scores = [score_log(regime, path, name) for regime, path in logs for name in INPUTS]
    found = [score for score in scores if score is not None]
    for line in markdown(found):
        print(line)
    if asked.json:
        asked.json.write_text(json.dumps([asdict(score) for score in found], indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

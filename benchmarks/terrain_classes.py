# SPDX-License-Identifier: Apache-2.0
"""How well surfaces are told apart, and unknown ones noticed, on drives that were left out of training whole.

Runs are dealt to folds; each fold is judged by a classifier that was trained, with all that is chosen and
calibrated in training, on the other folds' runs. Each surface is left out once, too: its windows are judged
by a classifier that has never seen it. A random forest on the same features and folds is beside it. Windows
that are judged do not overlap.

    python benchmarks/terrain_classes.py imu.csv.gz currents.csv.gz --folds 10
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.terrain import UNKNOWN, cut_windows, read_recordings
from slipwise.terrain.classifier import Answer, TerrainClassifier
from slipwise.terrain.scores import Score, score_of
from slipwise.terrain.train import OVERLAP, train_windows, usable_windows
from slipwise.terrain.windows import Cutting, Windows, cutting_of

Floats = NDArray[np.float64]

SHARES = (0.5, 0.65, 0.8, 0.85)
SENSORS = {"IMU and currents": (True, True), "IMU": (True, False), "currents": (False, True)}


def with_sensors(windows: Windows, vibration: bool, current: bool) -> Windows:
    """Blank out the sensors that are not to be used."""
    return replace(
        windows,
        vibration=windows.vibration if vibration else np.full_like(windows.vibration, np.nan),
        current=windows.current if current else np.full_like(windows.current, np.nan),
    )


def folds_of_runs(windows: Windows, folds: int, seed: int) -> dict[str, int]:
    """Deal the runs of each surface to folds; 0 folds leave out one run after the other."""
    rng, dealt = np.random.default_rng(seed), {}
    names = dict(zip(windows.run, windows.label, strict=True))
    order = sorted(names, key=lambda run: (names[run], rng.random()))
    for k, run in enumerate(order):
        dealt[run] = k if folds == 0 else k % folds
    return dealt


def forest_probabilities(train: Windows, test: Windows, surfaces: Sequence[str]) -> Floats:
    """Return what 400 plain trees say about windows with all sensors."""
    from sklearn.ensemble import RandomForestClassifier

    train = train.only(train.has_vibration & train.has_current)
    forest = RandomForestClassifier(400, random_state=0, n_jobs=1)
    forest.fit(np.hstack([train.vibration, train.current]), train.label.astype(str))
    found = forest.predict_proba(np.hstack([test.vibration, test.current]))
    return np.asarray(found[:, [list(forest.classes_).index(name) for name in surfaces]])


class LeaveRunsOut:
    """What classifiers say about windows of runs that they have not seen."""

    def __init__(self, train: Windows, test: Windows, surfaces: tuple[str, ...]) -> None:
        self.test, self.surfaces = test, surfaces
        self.probability = {
            name: np.full((len(test), len(surfaces)), np.nan) for name in [*SENSORS, "forest"]
        }
        self.labels = {
            (name, share): np.full(len(test), "", dtype=object) for name in SENSORS for share in SHARES
        }
        self._train = train

    def judge(self, rows: NDArray[np.bool_], cutting: Cutting, seed: int) -> None:
        """Train without the runs of these windows, and judge them."""
        out = np.isin(self._train.run.astype(str), np.unique(self.test.run[rows].astype(str)))
        made = train_windows(self._train.only(~out), cutting, seed=seed).classifier
        if made.surfaces != self.surfaces:
            raise SystemExit(f"without {set(self.test.run[rows])} there are only {made.surfaces}")
        for name, sensors in SENSORS.items():
            answer, labels = _said(made, with_sensors(self.test.only(rows), *sensors))
            self.probability[name][rows] = answer.probability
            for share in SHARES:
                self.labels[name, share][rows] = labels[share]
        self.probability["forest"][rows] = forest_probabilities(
            self._train.only(~out), self.test.only(rows), self.surfaces
        )

    def score(self, name: str) -> Score:
        """Return the score of all windows judged so far."""
        rows = np.isfinite(self.probability[name]).all(axis=1)
        return score_of(self.probability[name][rows], self.test.label[rows], self.surfaces)


def _said(made: TerrainClassifier, windows: Windows) -> tuple[Answer, dict[float, NDArray[np.object_]]]:
    answer = made.answer(windows)
    return answer, {share: made.labels(answer, share) for share in SHARES}


def unknown_shares(
    train: Windows, test: Windows, surfaces: Sequence[str], cutting: Cutting, seed: int
) -> dict[str, dict[str, dict[float, float]]]:
    """Return the share of windows called unknown of each surface, by a classifier that has not seen it."""
    found: dict[str, dict[str, dict[float, float]]] = {name: {} for name in SENSORS}
    for surface in surfaces:
        made = train_windows(train.only(train.label != surface), cutting, seed=seed).classifier
        own = test.only(test.label == surface)
        for name, sensors in SENSORS.items():
            _, labels = _said(made, with_sensors(own, *sensors))
            found[name][surface] = {share: float((labels[share] == UNKNOWN).mean()) for share in SHARES}
        print(f"without {surface}: done", file=sys.stderr, flush=True)
    return found


def show(judged: LeaveRunsOut, unknown: dict[str, dict[str, dict[float, float]]]) -> dict[str, Any]:
    """Print the tables; return their numbers."""
    print("runs left out        windows  right    ECE  log loss  " + "  ".join(judged.surfaces))
    content: dict[str, Any] = {"scores": {}, "unknown": {}}
    for name in judged.probability:
        score = judged.score(name)
        content["scores"][name] = asdict(score)
        recall = "  ".join(f"{score.recall[s]:>{len(s)}.2f}" for s in judged.surfaces)
        print(
            f"{name:<20} {score.windows:>7}  {score.accuracy:.3f}  {score.calibration_error:.3f}  "
            f"{score.log_loss:>8.3f}  {recall}"
        )
    print("\nsensors              asked  called unknown: not trained (mean; each)   trained   named  right")
    for name in SENSORS:
        for share in SHARES:
            labels, truth = judged.labels[name, share], judged.test.label
            strange = [unknown[name][surface][share] for surface in judged.surfaces]
            named = labels != UNKNOWN
            right = float((labels[named] == truth[named]).mean()) if named.any() else float("nan")
            numbers = (share, float(np.mean(strange)), float((~named).mean()), float(named.mean()), right)
            content["unknown"][f"{name}, {share}"] = (*numbers, strange)
            print(
                f"{name:<20}  {share:.2f}  {numbers[1]:.3f} ({' '.join(f'{s:.2f}' for s in strange)})  "
                f"{numbers[2]:>18.3f}   {numbers[3]:.3f}  {right:.3f}"
            )
    return content


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("logs", nargs="+", type=Path)
    parser.add_argument("--window", type=float, default=5.0, help="s")
    parser.add_argument("--folds", type=int, default=10, help="0: one run after the other")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    recordings, notes = read_recordings(given.logs)
    cutting = cutting_of(recordings, given.window)
    everything = cut_windows(recordings, cutting, step=given.window / OVERLAP)
    train, surfaces, more = usable_windows(everything)
    test = cut_windows(recordings, cutting, step=given.window)
    test = test.only(np.isin(test.label.astype(str), surfaces) & test.has_vibration & test.has_current)
    print("\n".join([*notes, *more]), file=sys.stderr)
    dealt = folds_of_runs(test, given.folds, given.seed)
    index = np.array([dealt[run] for run in test.run])
    judged = LeaveRunsOut(train, test, surfaces)
    for k in range(int(index.max()) + 1):
        judged.judge(index == k, cutting, given.seed)
        print(f"fold {k + 1}: {judged.score('IMU and currents')}", file=sys.stderr, flush=True)
    content = show(judged, unknown_shares(train, test, surfaces, cutting, given.seed))
    if given.json is not None:
        given.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""How soon changes of ground are found, and how often one is where there is none, beside other finders.

One learner runs over each drive and takes no notice of changes; all finders but slipwise's own see what it
says of each window before it learns it. Slipwise's are the log odds of a learner whose slip may jump. Drives
are simulated (steps of slip, from wheel speeds and from commands, with white slip noise and with slip noise
that lasts for seconds), and real: grounds of the Warthog's window sets one after the other. Finders are run
at every setting; of the settings with as few false alarms the one that is soonest counts. ruptures looks at
whole drives: its delay is how far its nearest change lies from the true one.
"""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import permutations
from pathlib import Path

import numpy as np
from alarm_rivals import FINDERS
from alarm_scores import LONGEST, Course, Point, at_budget, delays, false_alarms
from data_sets import data_folder
from numpy.typing import NDArray
from simulated_log import SLIP, Answer, simulated_log
from terrain_change import NOISES

import slipwise
from slipwise import _core
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.prepared_run import WindowSet, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Log
from slipwise_thesis.estimators import learned_parts

Floats = NDArray[np.float64]

MINUTES = 4.0  # of a simulated drive on either ground
YAW_STEPS = {f"yaw slip +{100 * step:.0f} %": (6, step * -0.35) for step in (0.10, 0.25, 0.50)}
FORWARD_STEPS = {f"forward slip +{100 * step:.0f} % of the speed": (0, -step) for step in (0.05, 0.10, 0.20)}
STEPS = YAW_STEPS | FORWARD_STEPS
GROUNDS = ("asphalt_8_7_11h30s30", "gravel_8_6_11h37s32", "sand_9_25_14h13s47")
WARTHOG_WINDOWS = 100  # of each ground
BUDGETS = (1.0, 3.0, 10.0)  # false alarms per 1000 windows


def course_of(windows: WindowSet, input_name: str, changes: tuple[int, ...]) -> Course:
    """Learn windows in their order by `auto`, with branches and without any reaction to a change."""
    following, average = (_average(input_name, branches=branches) for branches in (True, False))
    odds, signed, nis = [], [], []
    for i in range(len(windows)):
        following.learn(windows.input_history(i), windows.segments[i])
        update = average.learn(windows.input_history(i), windows.segments[i])
        unit = update.innovation / np.sqrt(np.diag(update.innovation_covariance))
        way = np.sign(windows.measured[i])
        odds.append(following.change.log_odds)
        signed.append((unit[0] * way[0], unit[2] * way[2]))
        nis.append(update.nis)
    return Course(np.array(odds), np.array(signed).reshape(-1, 2), np.array(nis), changes)


def _average(input_name: str, *, branches: bool) -> _core.ModelAverage:
    settings = Settings.model_validate({"change": {"branches": branches}})
    dynamics, offset = learned_parts(settings, input_name)
    filters = (settings.filter_settings(), _core.ModelAverageSettings())
    return _core.ModelAverage("auto", settings.bases(), dynamics, offset, False, *filters)


def windows_of(log: Log, input_name: str) -> WindowSet:
    """Return the windows that a log is learned from."""
    return learning_windows(prepare_run(log, input_name), input_name, Settings())


@dataclass(frozen=True)
class Drive:
    """A simulated drive with a step in its middle."""

    input_name: str
    noise: str
    step: str
    seed: int


def simulated(job: Drive) -> Course:
    """Drive on two grounds, one after the other."""
    term, change = STEPS[job.step]
    after = SLIP.copy()
    after[term] += change
    answer = Answer() if job.input_name == "command" else None
    noise = NOISES[job.noise]
    log = simulated_log(2 * MINUTES, seed=job.seed, slip_noise=noise, slips=(SLIP, after), answer=answer)
    windows = windows_of(log, job.input_name)
    at = int(np.searchsorted(windows.end, 60.0 * MINUTES, side="right"))
    return course_of(windows, job.input_name, (at,))


def warthog(order: tuple[str, ...]) -> Course:
    """Windows of three grounds in turn."""
    folder = data_folder()
    assert folder is not None
    parts = [
        windows_of(slipwise.open_log(folder / "warthog_windows" / f"{name}.csv.gz"), "wheel")
        for name in order
    ]
    joined = replace(
        parts[0],
        measured=np.concatenate([p.measured[:WARTHOG_WINDOWS] for p in parts]),
        start=np.concatenate([p.start[:WARTHOG_WINDOWS] for p in parts]),
        segments=tuple(s for p in parts for s in p.segments[:WARTHOG_WINDOWS]),
        histories=tuple(h for p in parts for h in p.histories[:WARTHOG_WINDOWS]),
    )
    lengths = np.cumsum([min(len(p), WARTHOG_WINDOWS) for p in parts])
    return course_of(joined, "wheel", tuple(int(n) for n in lengths[:-1]))


def curve(courses: list[Course], finder: str) -> list[Point]:
    """Run a finder at each of its settings."""
    find, settings = FINDERS[finder]
    offline = "off-line" in finder
    points = []
    for setting in settings:
        alarms = [find(course, setting) for course in courses]
        late = [d for c, a in zip(courses, alarms, strict=True) for d in delays(c, a, offline=offline)]
        counts = np.array([false_alarms(c, a, offline=offline) for c, a in zip(courses, alarms, strict=True)])
        rate = 1000.0 * counts[:, 0].sum() / max(counts[:, 1].sum(), 1)
        found = float(np.mean(np.array(late) < LONGEST))
        points.append(Point(finder, str(setting), float(rate), float(np.mean(late)), found))
    return points


def print_curves(title: str, curves: dict[str, list[Point]]) -> None:
    """Print the delay of each finder at each budget of false alarms."""
    print(f"\n{title}\n\n| finder | " + " | ".join(f"<= {b:g} false per 1000" for b in BUDGETS) + " |")
    print("|---|" + "---|" * len(BUDGETS))
    for finder, points in curves.items():
        best = [at_budget(points, budget) for budget in BUDGETS]
        cells = ["-" if p is None else f"{p.delay:.1f} ({100 * p.found:.0f} %)" for p in best]
        print(f"| {finder} | " + " | ".join(cells) + " |")


def groups(pool: ProcessPoolExecutor, seeds: int) -> dict[str, list[Course]]:
    """Drive everything; courses by what is shown together."""
    found: dict[str, list[Course]] = {}
    for name in ("wheel", "command"):
        for noise in ("white", "coloured"):
            for step in STEPS:
                jobs = [Drive(name, noise, step, seed) for seed in range(seeds)]
                found[f"{name}, {noise}: {step}"] = list(pool.map(simulated, jobs))
    if data_folder() is not None:
        found["Warthog: asphalt, gravel, sand in every order"] = list(
            pool.map(warthog, permutations(GROUNDS))
        )
    return found


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=6, help="drives of each step")
    parser.add_argument("--each", action="store_true", help="show each step by itself too")
    parser.add_argument("--json", type=Path, help="write all points to this file")
    arguments = parser.parse_args()
    with ProcessPoolExecutor() as pool:
        courses = groups(pool, arguments.seeds)
    joined: dict[str, list[Course]] = {}
    for title, part in courses.items():
        joined.setdefault(title.split(":")[0] + (": all steps" if "slip +" in title else ""), []).extend(part)
    shown = joined | courses if arguments.each else joined
    every = {title: {finder: curve(part, finder) for finder in FINDERS} for title, part in shown.items()}
    for title, curves in every.items():
        print_curves(title, curves)
    if arguments.json:
        content = {t: {f: [vars(p) for p in points] for f, points in c.items()} for t, c in every.items()}
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

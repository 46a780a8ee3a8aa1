# SPDX-License-Identifier: Apache-2.0
"""Draws the README's figure from a real log: a Husky, learned from two runs and predicted in a third."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import slipwise as sw
from slipwise.calibration import make_settings
from slipwise.files import write_whole
from slipwise.live.applied import without_slip
from slipwise.logs import Log, Run
from slipwise.reporting.png_picture import drawing_part, small_png

Floats = NDArray[np.float64]

LOG = "husky/tile_deflated_tyres.csv.gz"  # a Clearpath Husky, skid-steered, with soft tyres on tiles
INPUT = "command"
HORIZON = 5.0  # [s]
SHOWN = 5  # paths
PLAIN, SIMPLE, LEARNED = "none", "edd-2", "auto"
NAMES = {PLAIN: "as commanded", SIMPLE: "two fitted numbers", LEARNED: "slipwise"}
COLOURS = {PLAIN: "#9aa5b1", SIMPLE: "#d55e00", LEARNED: "#0072b2"}
DASHES = {PLAIN: ":", SIMPLE: "--", LEARNED: "-"}
SIZE, DPI, LARGEST = (7.6, 3.8), 130, 100_000  # [in], [1/in], [bytes]
TEXT = 12  # [pt], to be read on a phone


def parts(log: Log) -> tuple[Log, Run]:
    """Return the runs to learn from, and the last one to predict in."""
    return replace(log, runs=log.runs[:-1]), log.runs[-1]


def pose_at(run: Run, t: float) -> Floats:
    """Return the measured (x, y, yaw) at time t [s]."""
    poses = run.poses
    yaw = np.unwrap(poses.yaw)
    return np.array([np.interp(t, poses.t, values) for values in (poses.x, poses.y, yaw)])


def seen_from(start: Floats, points: Floats) -> Floats:
    """Return points [N, 2] of the map in the frame of the robot at `start` (x, y, yaw)."""
    cos, sin = np.cos(start[2]), np.sin(start[2])
    seen: Floats = (points - start[:2]) @ np.array([[cos, -sin], [sin, cos]])
    return seen


def starts(run: Run) -> list[float]:
    """Choose starts [s] whose motions differ: each time the one farthest from those chosen."""
    times = np.arange(run.poses.t[0] + 1.0, run.poses.t[-1] - HORIZON, HORIZON)
    ends = np.array([seen_from(pose_at(run, t), pose_at(run, t + HORIZON)[None, :2])[0] for t in times])
    taken = [int(np.argmax(np.linalg.norm(ends, axis=1)))]
    while len(taken) < SHOWN:
        apart = np.linalg.norm(ends[:, None] - ends[taken][None], axis=2).min(axis=1)
        taken.append(int(np.argmax(apart)))
    return [float(times[place]) for place in taken]


def draw_paths(axes: Any, run: Run, models: dict[str, sw.Model]) -> None:
    """Draw measured paths and those that each model predicts, seen from the robot at the start."""
    assert run.commands is not None
    assert run.wheels is not None
    for number, start in enumerate(starts(run)):
        inside = (run.poses.t >= start) & (run.poses.t <= start + HORIZON)
        here = pose_at(run, start)
        measured = seen_from(here, np.column_stack((run.poses.x, run.poses.y))[inside])
        wheels = int(np.searchsorted(run.wheels.t, start, side="right")) - 1
        initial = (float(run.wheels.v[wheels]), float(run.wheels.omega[wheels]))
        axes.plot(*measured.T, color="black", linewidth=3.2, alpha=0.85, label=None if number else "measured")
        for method, model in models.items():
            path = sw.predict(model, run.commands, horizon=HORIZON, start=start, initial=initial)
            name = None if number else NAMES[method]
            style = {"color": COLOURS[method], "linestyle": DASHES[method], "linewidth": 2.0, "label": name}
            axes.plot(*path.poses[:, :2].T, **style)
            axes.plot(*path.poses[-1, :2], "o", color=COLOURS[method], markersize=4)
        axes.plot(*measured[-1], "o", color="black", markersize=6)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(title="The next 5 s, predicted from the commands", xlabel="x [m]", ylabel="y [m]")


def draw_errors(axes: Any, evaluation: sw.Evaluation) -> None:
    """Draw the mean held-out position error at the horizon with its 95 % interval."""
    for place, method in enumerate((LEARNED, SIMPLE, PLAIN)):
        error = evaluation.score(method, HORIZON).position
        spread = [[error.mean - error.low], [error.high - error.mean]]
        axes.barh(place, error.mean, xerr=spread, color=COLOURS[method], height=0.6, capsize=3)
        axes.text(error.high, place, f"  {error.mean:.3f} m", va="center", fontsize=TEXT)
        axes.text(0.0, place + 0.36, NAMES[method], va="bottom", fontsize=TEXT)
    windows = evaluation.score(PLAIN, HORIZON).windows
    axes.set(title="Mean error after 5 s", xlabel=f"[m], {windows} held-out windows", yticks=[])
    axes.set_xlim(0.0, 1.5 * evaluation.score(PLAIN, HORIZON).position.high)
    axes.set_ylim(-0.5, 2.85)


def save(path: Path, picture: bytes) -> None:
    """Write the bytes of a picture."""
    path.write_bytes(picture)


def main(folder: Path) -> Path:
    """Write the figure into `folder`; return its path."""
    data = os.environ.get("SLIPWISE_DATA")
    if not data:
        sys.exit("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
    log = sw.open_log(Path(data) / LOG)
    earlier, last = parts(log)
    learned = {
        name: sw.calibrate(earlier, input=INPUT, settings=make_settings({"basis": name})).model
        for name in (SIMPLE, LEARNED)
    }
    models = {PLAIN: without_slip(learned[SIMPLE], "It is drawn beside others.")} | learned
    options = sw.EvaluationOptions(horizons=(HORIZON,), methods=(PLAIN, SIMPLE, LEARNED))
    evaluation = sw.evaluate(log, input=INPUT, options=options)
    drawing_part("pyplot").rcParams.update(
        {"axes.spines.top": False, "axes.spines.right": False, "font.size": TEXT, "axes.titlesize": TEXT}
    )
    figure = drawing_part("figure").Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.55, 1.0))
    draw_paths(left, last, models)
    left.legend(fontsize=TEXT - 1, frameon=False, loc="lower right", handlelength=1.2)
    draw_errors(right, evaluation)
    path = folder / "prediction.png"
    picture = small_png(figure, dpi=DPI, largest=LARGEST)
    write_whole(path, lambda target: save(target, picture))
    return path


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)

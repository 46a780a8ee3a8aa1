# SPDX-License-Identifier: Apache-2.0
"""Draws the README's figure from a seeded simulation; needs matplotlib, which slipwise itself does not."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import NDArray

import slipwise as sw
from slipwise.logs import Inputs, Log, Poses
from slipwise.simulation import Scenario, simulate
from slipwise.student import ellipse_squared

Floats = NDArray[np.float64]

SEED = 7
HORIZON = 5.0  # [s]
LEARNED_UNTIL, END = 300.0, 366.0  # [s] the paths are predicted in the minute after the part that is learned
STARTS = np.arange(LEARNED_UNTIL, END - HORIZON, 10.0)  # [s]
PLAIN, SIMPLE, LEARNED = "none", "edd-2", "auto"
COLOURS = {PLAIN: "#c1443c", SIMPLE: "#8a8a8a", LEARNED: "#1f6fb2"}
LABELS = {PLAIN: "as commanded", SIMPLE: "edd-2 with lag and delay", LEARNED: "slipwise"}
HELD = 0.95  # share of the positions in an ellipse


def until(log: Log, t: float) -> Log:
    """Return what had been recorded by time t [s]."""
    run = log.runs[0]
    poses, commands = run.poses, run.commands
    assert commands is not None
    seen, told = int(np.searchsorted(poses.t, t)), int(np.searchsorted(commands.t, t))
    earlier_poses = Poses(
        t=poses.t[:seen], x=poses.x[:seen], y=poses.y[:seen], yaw=poses.yaw[:seen], frame=poses.frame[:seen]
    )
    earlier_commands = Inputs(
        t=commands.t[:told], v=commands.v[:told], vy=commands.vy[:told], omega=commands.omega[:told]
    )
    return replace(log, runs=(replace(run, poses=earlier_poses, commands=earlier_commands),))


def pose_at(log: Log, t: float) -> Floats:
    """Return the measured (x, y, yaw) nearest to time t [s]."""
    poses = log.runs[0].poses
    at = int(np.argmin(np.abs(poses.t - t)))
    return np.array([poses.x[at], poses.y[at], poses.yaw[at]])


def ellipse(centre: Floats, covariance: Floats, dof: float) -> Ellipse:
    """Return the ellipse that holds 95 % of a Student t."""
    variances, axes = np.linalg.eigh(covariance)
    width, height = 2.0 * np.sqrt(ellipse_squared(HELD, dof) * variances)
    angle = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    centre_xy = (float(centre[0]), float(centre[1]))
    return Ellipse(centre_xy, width, height, angle=angle, color=COLOURS[LEARNED], alpha=0.25, linewidth=0)


def draw_paths(axes: Axes, log: Log, models: dict[str, sw.Model]) -> None:
    """Draw the measured path, and the 5 s that each model predicts from the commands at some starts."""
    run = log.runs[0]
    assert run.commands is not None
    assert run.wheels is not None
    shown = (run.poses.t >= LEARNED_UNTIL) & (run.poses.t <= END)
    axes.plot(run.poses.x[shown], run.poses.y[shown], color="black", linewidth=1.0, label="measured")
    for method, model in models.items():
        label: str | None = LABELS[method]
        for start in STARTS.tolist():
            x, y, yaw = pose_at(log, start)
            wheels = int(np.searchsorted(run.wheels.t, start, side="right")) - 1
            initial = (float(run.wheels.v[wheels]), float(run.wheels.omega[wheels]))
            path = sw.predict(model, run.commands, horizon=HORIZON, start=start, initial=initial)
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            points = path.poses[:, :2] @ turn.T + (x, y)
            axes.plot(*points.T, color=COLOURS[method], linewidth=2.2, alpha=0.9, label=label)
            axes.plot(*pose_at(log, start + HORIZON)[:2], "o", color="black", markersize=4, zorder=3)
            label = None
            if method == LEARNED:
                spread = turn @ path.covariance[-1, :2, :2] @ turn.T
                axes.add_patch(ellipse(points[-1], spread, float(path.dof[-1])))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title("The next 5 s, predicted from the commands", fontsize=10)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.legend(fontsize=8, frameon=False, loc="best")


def draw_errors(axes: Axes, evaluation: sw.Evaluation) -> None:
    """Draw the mean position error per horizon with its 95 % interval."""
    for method in (PLAIN, SIMPLE, LEARNED):
        scores = [evaluation.score(method, horizon) for horizon in evaluation.horizons]
        mean = np.array([score.position.mean for score in scores])
        low = mean - np.array([score.position.low for score in scores])
        high = np.array([score.position.high for score in scores]) - mean
        axes.errorbar(
            evaluation.horizons,
            mean,
            (low, high),
            color=COLOURS[method],
            label=LABELS[method],
            marker="o",
            capsize=3,
        )
    axes.set_yscale("log")
    ticks = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
    axes.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_title("Mean held-out position error", fontsize=10)
    axes.set_xlabel("horizon [s]")
    axes.set_ylabel("[m]")
    axes.legend(fontsize=8, frameon=False)


def main(folder: Path) -> Path:
    """Write the figure into `folder`; return its path."""
    mpl.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "font.size": 9})
    log = simulate(Scenario(duration=END), seed=SEED).log
    earlier = until(log, LEARNED_UNTIL)
    learned = sw.calibrate(earlier, input="command").model
    plain = sw.Model(
        learned.content.model_copy(
            update={
                "slip": learned.content.slip.model_copy(update={"lon": [], "lat": [], "ang": []}),
                "parameters": [],
                "covariance": [],
                "dynamics": False,
            }
        )
    )
    options = sw.EvaluationOptions(methods=(PLAIN, SIMPLE, LEARNED))
    evaluation = sw.evaluate(earlier, input="command", options=options)
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.7, 1.0))
    draw_paths(left, log, {PLAIN: plain, LEARNED: learned})
    draw_errors(right, evaluation)
    path = folder / "prediction.png"
    figure.savefig(path, dpi=120, metadata={"Software": None})
    return path


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)

# SPDX-License-Identifier: Apache-2.0
"""Uses that drive: what a learned model predicts, plans and commands, held against the true robot."""

from __future__ import annotations

import math
import subprocess
from dataclasses import replace

import numpy as np
from matrix.learned import Learned, verb
from matrix.simulator import Floats, in_space

import slipwise as sw
from slipwise import planning
from slipwise.ground import Grade

SECONDS = 4.0  # of a manoeuvre
PERIOD = 0.05  # s of rollouts and controllers


def close(learned: Learned, end: Floats, truth: Floats, *, share: float = 1.0) -> None:
    """Hold an end of a path against the truth."""
    metres, radians = (share * each for each in learned.situation.bound)
    off = float(np.hypot(*(end[:2] - truth[:2]))), float(abs(end[2] - truth[2]))
    assert off[0] <= metres or learned.situation.turns, (
        f"ends {off[0]:.3f} m off the truth, where {metres:g} m is the bound"
    )
    assert off[1] <= radians, f"ends {off[1]:.3f} rad off the truth, where {radians:g} rad is the bound"


def ground(learned: Learned) -> Grade | None:
    """Return the plane that the robot drives on."""
    slope = learned.situation.robot.slope
    return Grade(slope=slope, downhill=math.pi) if slope else None


def predict(learned: Learned) -> None:
    """A path ends where the truth does, and surely within its covariance; a known force pushes it so, too."""
    situation, manoeuvre = learned.situation, learned.situation.manoeuvre
    cases = [((0.0, 0.0), situation.moves)]
    if situation.robot.force[0]:
        cases.append(((0.0, 1.2), replace(situation.moves, force=(1.2, math.inf))))
    for force, robot in cases:
        path = sw.predict(
            learned.model,
            situation.rows(manoeuvre),
            horizon=SECONDS,
            ground=ground(learned),
            known_force=force,
        )
        truth = situation.end(manoeuvre, SECONDS, robot)
        close(learned, path.end, truth)
        off = path.end - truth
        nis = float(off @ np.linalg.solve(path.covariance[-1], off))
        assert nis < 25.0, f"the truth is {math.sqrt(nis):.1f} standard deviations away"


def rollout(learned: Learned) -> None:
    """Rollouts end where the truth does."""
    situation, manoeuvre = learned.situation, learned.situation.manoeuvre
    t = np.arange(round(SECONDS / PERIOD)) * PERIOD
    at = np.searchsorted(manoeuvre[:, 0], t + 1e-9, side="right") - 1
    rows = situation.rows(manoeuvre)[at, 1:]
    start = planning.Start(grade=ground(learned))
    ends = planning.rollout(learned.model, rows[None], PERIOD, start=start, outputs=("end",)).end
    assert ends is not None
    close(learned, ends[:, 0].astype(np.float64), situation.end(manoeuvre, SECONDS))


def mppi(learned: Learned) -> None:
    """A controller that drives through the model keeps the true robot on a line that it starts beside."""
    situation, options = learned.situation, planning.MppiOptions(rollouts=256, periods=40)
    options = options.for_car() if situation.robot.kind == "throttle" else options
    points = np.column_stack((np.arange(0.0, 16.0, 0.1), np.full(160, 0.2)))
    motions = planning.learned_motions(learned.model, grade=ground(learned))
    controller = planning.Controller(motions, planning.ReferencePath(points, speed=0.6), options=options)
    pose, wheels, sent = np.zeros(3), np.zeros(3), []
    for k in range(round(1.5 * SECONDS / PERIOD)):
        drive = tuple(wheels) if situation.axes == 3 else (wheels[0], wheels[2])
        command = controller.command(tuple(pose), drive)
        sent.append((k * PERIOD, *command))
        driven = situation.driven(situation.given(np.array(sent)), (k + 1) * PERIOD)
        pose, wheels = in_space(situation.robot, driven.pose[-1:])[0, [0, 1, 5]], driven.wheels[-1]
    assert abs(pose[1] - 0.2) < 0.08, f"{pose[1] - 0.2:+.3f} m beside the line"
    assert pose[0] > 1.0, f"only {pose[0]:.2f} m ahead"


def trajectory(learned: Learned) -> None:
    """The commands that are planned to a goal bring the true robot there."""
    goal = np.array([2.0, 0.6, 0.5])
    plan = planning.trajectory_to(learned.model, tuple(goal), ground=ground(learned))
    close(learned, learned.situation.end(learned.situation.given(plan.commands), plan.duration), goal)


DRIVER = r"""
#include <stdio.h>
#include "model.h"
int main(void) {
  slipwise_command slots[64];
  slipwise_commands commands;
  slipwise_window window = {0};
  slipwise_pose pose = {0, 0, 0};
  double t, AXES;
  slipwise_commands_init(&commands, slots, 64);
  while (scanf(FORMAT, &t, ADDRESSES) == COUNT) {
    slipwise_command_push(&commands, (slipwise_real)t, VALUES);
  }
  window.end = (slipwise_real)SECONDS;
  if (slipwise_predict(&commands, &window, &pose, 0) != SLIPWISE_OK) {
    return 1;
  }
  printf("%.9g %.9g %.9g\n", (double)pose.x, (double)pose.y, (double)pose.yaw);
  return 0;
}
"""


def header(learned: Learned) -> None:
    """The C header compiles without a warning, and its path ends where the truth does."""
    situation, folder = learned.situation, learned.folder
    verb("export", learned.path, "--to", "c-header", "--force", "-o", folder / "model.h")
    names = [f"u{k}" for k in range(situation.axes)]
    text = DRIVER.replace("AXES", ", ".join(names)).replace("FORMAT", '"' + "%lf " * (1 + len(names)) + '"')
    text = text.replace("ADDRESSES", ", ".join(f"&{n}" for n in names)).replace("COUNT", str(1 + len(names)))
    text = text.replace("VALUES", ", ".join(f"(slipwise_real){n}" for n in names))
    (folder / "driver.c").write_text(text.replace("SECONDS", str(SECONDS)), encoding="utf-8")
    strict = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
    build = ["gcc", *strict, "driver.c", "-o", "driver", "-lm"]
    built = subprocess.run(build, cwd=folder, capture_output=True, text=True, check=False, timeout=60)
    assert built.returncode == 0, built.stderr
    rows = "\n".join(" ".join(map(repr, row)) for row in situation.rows(situation.manoeuvre).tolist())
    done = subprocess.run(
        [folder / "driver"], input=rows, capture_output=True, text=True, check=True, timeout=10
    )
    end = np.array([float(number) for number in done.stdout.split()])
    close(learned, end, situation.end(situation.manoeuvre, SECONDS, situation.exported))


def excite(learned: Learned) -> None:
    """The drive that it plans is in the commands of this robot, and keeps the true one inside the area."""
    stem, situation = learned.folder / "excite", learned.situation
    verb("excite", "--model", learned.path, "--area", "12x12", "--minutes", "0.4", "-o", stem)
    with stem.with_suffix(".csv").open(encoding="utf-8") as file:
        names = file.readline().strip().split(",")[1:]
        planned = np.loadtxt(file, delimiter=",", ndmin=2)
    given = situation.given(planned)
    if situation.robot.kind == "throttle":
        assert np.abs(planned[:, 1:]).max() <= 1.0, "throttle or steering beyond 1"
    if situation.robot.kind == "steering":
        tightest = math.tan(situation.ranges[1][1]) / situation.robot.wheelbase
        assert 0.75 * tightest < (learned.model.content.range.curvature or 0.0) <= tightest
        assert np.abs(planned[:, 2]).max() > 0.7 * tightest * 0.7 * situation.ranges[0][1]
    driven = situation.driven(given, float(planned[-1, 0]) + 1.0)
    assert np.ptp(driven.pose[:, :2], axis=0).max() < 12.0, "it leaves the area"
    assert np.abs(planned[:, 1:]).max(axis=0).min() > 0.0, f"an axis of {names} is never driven"

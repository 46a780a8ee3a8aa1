# SPDX-License-Identifier: Apache-2.0
"""Cars commanded by throttle and steering: `auto` beside a bicycle with the best gains in hindsight.

The logs are those of DART (github.com/Lorenzo-Lyons/DART, MIT), as tables with the columns run, t, throttle,
steering, safety (throttle acts only where it is 1), x, y, yaw; the marker is moved to the rear axle by their
numbers. Every window after the first is predicted causally; the bicycle's two gains are fitted to the very
windows that are scored.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import slipwise as sw
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import prepare_run
from slipwise.logs import LogOptions
from slipwise.logs.log import Run

Floats = NDArray[np.float64]

LOGS = ("dart_steering_steps_rubbery", "dart_rubbery_floor", "dart_tape_and_tiles")
MARKER = (0.115, -0.01, 0.0077)  # m ahead of the rear axle and to its left, rad
ALL = slice(None)
STARTS = ((1.5, 2.0), (4.0, 2.0))  # m/s and 1/m, from which gains are looked for


def read(path: Path, folder: Path) -> sw.Log:
    """Read a log of DART, its poses at the rear axle."""
    import pandas as pd

    table = pd.read_csv(path)
    ahead, left, turned = MARKER
    yaw = table.yaw - turned
    rows = pd.DataFrame({name: table[name] for name in ("run", "t", "steering", "pose_new")})
    rows["throttle"] = table.throttle.where(table.safety == 1, 0.0)
    rows["x"] = table.x - ahead * np.cos(yaw) + left * np.sin(yaw)
    rows["y"] = table.y - ahead * np.sin(yaw) - left * np.cos(yaw)
    rows["yaw"] = yaw
    target = folder / f"{path.name.removesuffix('.csv.gz')}.csv"
    rows.to_csv(target, index=False)
    return sw.open_log(target, options=LogOptions(vehicle="dart"))


def bicycle(run: Run, window: tuple[float, float], gains: Floats) -> Floats:
    """Return the pose after a window under two constant gains."""
    commands = run.commands
    assert commands is not None
    assert commands.car is not None
    first, last = np.searchsorted(commands.t, np.array(window) - 1e-6).tolist()
    v = gains[0] * commands.car.throttle[first:last]
    step = np.diff(commands.t[first : last + 1])
    v = v[: len(step)]
    turn = np.concatenate(
        ([0.0], np.cumsum(v * gains[1] * commands.car.steering[first:last][: len(step)] * step))
    )
    middle = 0.5 * (turn[1:] + turn[:-1])
    return np.array([np.sum(v * step * np.cos(middle)), np.sum(v * step * np.sin(middle)), turn[-1]])


def errors(measured: Floats, pose: Floats) -> tuple[float, float]:
    """Return mean errors of position [m] and heading [rad]."""
    off = measured - pose
    heading = np.abs((off[:, 2] + np.pi) % (2.0 * np.pi) - np.pi)
    return float(np.hypot(off[:, 0], off[:, 1]).mean()), float(heading.mean())


def best_gains(log: sw.Log, made: Predictions, part: slice) -> Floats:
    """Return the gains of the bicycle that suit some windows best."""
    from scipy.optimize import minimize

    measured = made.measured[part]

    def cost(gains: Floats) -> float:
        return errors(measured, bicycle_poses(log, made, part, gains))[0]

    found = [minimize(cost, start, method="Nelder-Mead", options={"maxiter": 60}) for start in STARTS]
    return np.asarray(min(found, key=lambda each: float(each.fun)).x)


def bicycle_poses(log: sw.Log, made: Predictions, part: slice, gains: Floats) -> Floats:
    """Return the poses after some windows under two constant gains, [N, 3]."""
    windows = zip(
        made.run[part].tolist(), made.t_start[part].tolist(), made.t_end[part].tolist(), strict=True
    )
    return np.array([bicycle(log.runs[run], (start, end), gains) for run, start, end in windows])


def row(path: Path, horizon: float) -> dict[str, object]:
    """Score one log."""
    with tempfile.TemporaryDirectory() as folder:
        log = read(path, Path(folder))
    drive = prepare_run(log, "command")
    (made,) = learn_log(drive, sw.Settings(), (horizon,)).predictions
    auto, plain = (
        errors(made.measured, made.pose),
        errors(made.measured, bicycle_poses(log, made, ALL, best_gains(log, made, ALL))),
    )
    return {
        "log": path.name.removesuffix(".csv.gz"),
        "windows": len(made),
        "bicycle_m": plain[0],
        "auto_m": auto[0],
        "position_ratio": auto[0] / plain[0],
        "heading_ratio": auto[1] / plain[1],
    }


def main() -> None:
    """Print a row of JSON for each log."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="with the logs of DART")
    parser.add_argument("--horizon", type=float, default=1.0, help="s")
    given = parser.parse_args()
    for name in LOGS:
        print(json.dumps(row(given.folder / f"{name}.csv.gz", given.horizon)))


if __name__ == "__main__":
    main()

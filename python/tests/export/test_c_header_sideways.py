# SPDX-License-Identifier: Apache-2.0
"""The C header of a robot that drives sideways: commands (v, vy, omega), and what is predicted of them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_models import LIMITS, Made, make_model, named

from slipwise import _core
from slipwise.export import export_model
from slipwise.models import Model
from slipwise.prediction import predict

Floats = NDArray[np.float64]

STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-fno-math-errno")
TOLERANCE = {"float": 1e-4, "double": 1e-9}
OMNI = _core.Basis(
    "own", ["V", "abs(Vy)*V", "V3*V*2.5"], ["Vy", "V3*0.5", "gy*0.05"], ["w", "Vy", "abs(Vy)*w/g"]
)
DRIVER = r"""
#include <stdio.h>
#include "model.h"

/* Reads commands, then start, end, known, v, vy, omega; prints the pose, the drive after, and var(y). */
int main(void) {
  slipwise_command slots[512];
  slipwise_commands commands;
  double t, end, v, vy, omega;
  int count, known;
  if (scanf("%d", &count) != 1) {
    return 1;
  }
  slipwise_commands_init(&commands, slots, 512);
  for (; count > 0 && scanf("%lf %lf %lf %lf", &t, &v, &vy, &omega) == 4; --count) {
    if (slipwise_command_push(&commands, (slipwise_real)t, (slipwise_real)v, (slipwise_real)vy,
                              (slipwise_real)omega)) {
      return 2;
    }
  }
  while (scanf("%lf %lf %d %lf %lf %lf", &t, &end, &known, &v, &vy, &omega) == 6) {
    slipwise_window window;
    slipwise_drive drive, after = {0, 0, 0};
    slipwise_pose pose = {0, 0, 0};
    slipwise_real covariance[3][3];
    drive.v = (slipwise_real)v;
    drive.vy = (slipwise_real)vy;
    drive.omega = (slipwise_real)omega;
    window.start = (slipwise_real)t;
    window.end = (slipwise_real)end;
    window.drive = known ? &drive : 0;
    window.gx = window.gy = 0;
    if (slipwise_predict_covariance(&commands, &window, &pose, &after, covariance)) {
      return 3;
    }
    printf("%.17g %.17g %.17g %.17g %.17g\n", (double)pose.x, (double)pose.y, (double)pose.yaw,
           (double)after.vy, (double)covariance[1][1]);
  }
  return 0;
}
"""


def made(**other: object) -> Model:
    names = [info.name for info in _core.MotionModel(OMNI, False, False).parameters]
    values = dict(zip(names, np.random.default_rng(4).uniform(-0.2, 0.2, len(names)).tolist(), strict=True))
    return make_model(Made(OMNI, values, **other))  # type: ignore[arg-type]


MODELS = {
    "wheels": made(clock_offset=0.05),
    "commands": made(commands=True),
    "limits": made(commands=True, limits={axis: LIMITS[axis] for axis in ("speed", "yaw_rate")}),
    "slow mode": made(response=True, clock_offset=-0.05),
}
WINDOWS = ((3.0, 8.0, None), (4.5, 9.5, (0.25, -0.5, 0.125)), (6.0, 6.0, None))


def commands_of(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.integers(1, 64, 40)) / 64.0
    columns = [
        np.round(rng.uniform(*span, len(t)) * 64.0) / 64.0 for span in ((-0.5, 1.5), (-0.6, 0.6), (-1, 1))
    ]
    return np.column_stack((t - t[0], *columns))


def header_says(folder: Path, model: Model, commands: Floats, number: str, compiler: str) -> Floats:
    """Return rows of (x, y, yaw, vy after, variance of y)."""
    header = export_model(model, "c-header", name="model.yaml").text
    (folder / "model.h").write_text(header, encoding="utf-8")
    source = folder / ("driver.cpp" if compiler == "g++" else "driver.c")
    source.write_text(DRIVER, encoding="utf-8")
    define = ["-DSLIPWISE_DOUBLE"] if number == "double" else []
    standard = "-std=c++17" if compiler == "g++" else "-std=c99"
    build = [compiler, standard, *STRICT, *define, source.name, "-o", "driver", "-lm"]
    subprocess.run(build, cwd=folder, check=True, timeout=60)
    rows = [str(len(commands)), *(" ".join(map(repr, row)) for row in commands.tolist())]
    for start, end, drive in WINDOWS:
        rows.append(" ".join(map(repr, (start, end, int(drive is not None), *(drive or (0.0, 0.0, 0.0))))))
    done = subprocess.run(
        [folder / "driver"], input="\n".join(rows), capture_output=True, text=True, check=True, timeout=30
    )
    return np.array([[float(number) for number in line.split()] for line in done.stdout.splitlines()])


@pytest.mark.slow
def test_header_of_a_sideways_robot_predicts_what_slipwise_does(tmp_path: Path) -> None:
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    wrong = []
    for name, model in MODELS.items():
        commands = commands_of(len(name))
        noise = model.content.noise.model_copy(update={"pose_std_xy": 0.0, "pose_std_yaw": 0.0})
        exact = Model(model.content.model_copy(update={"noise": noise}))
        paths = [
            predict(exact, commands, horizon=end - start, start=start, initial=drive)
            for start, end, drive in WINDOWS
            if end > start
        ]
        for number, compiler in (("double", "gcc"), ("float", "gcc"), ("double", "g++")):
            rows = header_says(tmp_path, model, commands, number, compiler)
            for row, path in zip(rows, paths, strict=False):
                gap = np.abs(row[:3] - path.end).max()
                wrong += [(name, number, "pose", gap)] if gap > TOLERANCE[number] else []
                spread = abs(row[4] / path.covariance[-1, 1, 1] - 1.0)
                wrong += [(name, number, "variance", spread)] if spread > 0.1 else []
    assert not wrong


def test_header_of_other_robots_has_no_sideways_speed() -> None:
    text = export_model(make_model(named("edd-2", ang__w=-0.3)), "c-header", name="model.yaml").text
    assert "vy" not in text
    assert "@SIDE" not in text
    assert "slipwise_real vy" in export_model(MODELS["wheels"], "c-header", name="model.yaml").text

# SPDX-License-Identifier: Apache-2.0
"""The C header states the covariance that `slipwise.predict` states."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from export.test_c_header import STRICT, commands_of, random_values
from sample_models import LIMITS, Made, make_model, named

from slipwise import _core
from slipwise.export import export_model
from slipwise.models import Model
from slipwise.prediction import predict

pytestmark = pytest.mark.slow

DRIVER = r"""
#include <stdio.h>
#include "model.h"

/* Reads a number of commands and commands, then ends of windows from 2 s on; prints what is predicted. */
int main(void) {
  slipwise_command slots[512];
  slipwise_commands commands;
  double t, v, omega, end;
  int count;
  slipwise_commands_init(&commands, slots, 512);
  if (scanf("%d", &count) != 1) {
    return 1;
  }
  for (; count > 0 && scanf("%lf %lf %lf", &t, &v, &omega) == 3; --count) {
    slipwise_command_push(&commands, (slipwise_real)t, (slipwise_real)v, (slipwise_real)omega);
  }
  while (scanf("%lf", &end) == 1) {
    slipwise_window window = {2, 0, 0, 0, 0};
    slipwise_pose pose = {0, 0, 0};
    slipwise_real c[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, inflation, dof;
    int status, i;
    window.end = (slipwise_real)end;
    status = slipwise_predict_covariance(&commands, &window, &pose, 0, c);
    slipwise_tail(window.end - window.start, &inflation, &dof);
    printf("%d %.17g %.17g %.17g", status, (double)pose.x, (double)pose.y, (double)pose.yaw);
    for (i = 0; i < 9; ++i) {
      printf(" %.17g", (double)c[i / 3][i % 3]);
    }
    printf(" %.17g\n", (double)dof);
  }
  return 0;
}
"""


def run(model: Model, folder: Path, number: str, commands: np.ndarray, ends: list[float]) -> np.ndarray:
    """Compile the header's prediction; return rows of status, pose, covariance and degrees of freedom."""
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    (folder / "model.h").write_text(export_model(model, "c-header", name="m.yaml").text, encoding="utf-8")
    (folder / "driver.c").write_text(DRIVER, encoding="utf-8")
    define = ["-DSLIPWISE_DOUBLE"] if number == "double" else []
    command = ["gcc", "-std=c99", "-O1", *STRICT, *define, "driver.c", "-o", "driver", "-lm"]
    subprocess.run(command, cwd=folder, check=True, timeout=60)
    rows = [str(len(commands)), *(" ".join(map(repr, row)) for row in commands.tolist()), *map(repr, ends)]
    done = subprocess.run(
        [folder / "driver"], input="\n".join(rows), capture_output=True, text=True, check=True, timeout=30
    )
    return np.array([[float(n) for n in line.split()] for line in done.stdout.splitlines()])


def with_tails(model: Model) -> Model:
    """The model with noise of all kinds, and students that differ between horizons."""
    noise = model.content.noise.model_dump()
    noise |= {
        "variance_scale": [1.5, 0.7, 2.0],
        "student_t": {1.0: {"inflation": 1.4, "dof": 5.0}, 5.0: {"inflation": 2.6, "dof": 3.0}},
    }
    content = model.content.model_copy(update={"noise": type(model.content.noise).model_validate(noise)})
    return Model(content)


MODELS = {
    "wheel speeds": Made(
        _core.named_basis("odd-even-10"), random_values(_core.named_basis("odd-even-10"), 3)
    ),
    "commands": replace(named("full-linear-6", lon__V=-0.05, ang__w=-0.4), commands=True, clock_offset=0.05),
    "response": replace(named("edd-2", lon__V=-0.05, ang__w=-0.3), response=True),
    "slip disturbance": replace(
        named("full-linear-6", lon__V=-0.05, ang__w=-0.4), disturbance=(0.1, 0.3, 2.0), commands=True
    ),
    "limits": replace(named("edd-2", lon__V=-0.05, ang__w=-0.3), response=True, limits=LIMITS),
}


@pytest.mark.parametrize("number", ["float", "double"])
@pytest.mark.parametrize("kind", MODELS)
def test_header_states_the_covariance_of_predict(tmp_path: Path, kind: str, number: str) -> None:
    model = with_tails(make_model(MODELS[kind]))
    commands = commands_of(seed=11)
    path = predict(model, commands, horizon=6.0, start=2.0)
    rows = run(model, tmp_path, number, commands, path.t[1:].tolist())
    assert not rows[:, 0].any()
    found = rows[:, 4:13].reshape(-1, 3, 3)
    stds = np.sqrt(np.einsum("nii->ni", path.covariance[1:]))
    correlations = (found - path.covariance[1:]) / (stds[:, :, None] * stds[:, None, :])
    assert np.abs(correlations).max() < {"float": 1e-2, "double": 1e-3}[number]
    assert rows[:, 13] == pytest.approx(path.dof[1:], rel=1e-5)
    assert np.abs(stds[-1]).min() > 0.01


def test_a_model_without_parameters_has_a_covariance_of_noise_alone(tmp_path: Path) -> None:
    model = make_model(Made(_core.Basis("none", [], [], []), {}))
    commands = commands_of(seed=11)
    path = predict(model, commands, horizon=3.0, start=2.0)
    row = run(model, tmp_path, "double", commands, [5.0])[0]
    assert row[4:13].reshape(3, 3) == pytest.approx(path.covariance[-1], rel=1e-6, abs=1e-12)


def test_a_window_that_is_refused_leaves_the_covariance_as_it_was(tmp_path: Path) -> None:
    model = make_model(named("edd-2"))
    row = run(model, tmp_path, "float", commands_of(seed=11), [1.0])[0]
    assert row[0] == 1
    assert not row[1:13].any()

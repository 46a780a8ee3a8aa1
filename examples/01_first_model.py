# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""A first model: simulate a robot, learn how it slips and lags, ask whether that helps, and predict."""

# A planner tells a six-wheel skid-steered robot how fast to go. The robot turns less than commanded, and
# later. By how much? The drive below is simulated, so that nothing is needed but this file; with a log of
# your own, replace `simulate` by `sw.open_log("run.mcap")`.

# %%
from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import slipwise as sw
from slipwise_sim import Scenario, simulate

log = simulate(Scenario(duration=150.0), seed=3).log

# %% [markdown]
# Learn from the commands and the poses. The verdict compares the model with the plain one, "the robot does
# what it is commanded", on predictions that were made before the data they are judged by had been learned.

# %%
result = sw.calibrate(log, input="command")
print(result.verdict)
assert result.verdict.good

# %% [markdown]
# What was learned, in words, and then each parameter with its standard deviation. `ang.w` is the fraction of
# the commanded yaw rate that is lost (it is negative: the robot turns less than is commanded).

# %%
print(sw.summarise(result.model))
for parameter in result.model.parameters.values():
    print(parameter, "" if parameter.identified else "(not identified)")
assert -0.6 < result.model["ang.w"].value < -0.2

# %% [markdown]
# The model file is the only thing that a planner needs. It reads back to the same model.

# %%
with tempfile.TemporaryDirectory() as folder:
    file = result.model.save(Path(folder) / "model.yaml")
    model = sw.load_model(file)
assert model.content == result.model.content

# %% [markdown]
# Where is the robot after 5 s of 1 m/s and 0.3 rad/s, starting at rest? As commanded, it would have turned by
# 1.5 rad.

# %%
commands = np.array([[0.0, 1.0, 0.3]])  # rows of t [s], v [m/s], omega [rad/s]; held until the next row
path = sw.predict(model, commands, horizon=5.0, initial=(0.0, 0.0))
x, y, yaw = path.poses[-1]
std = np.sqrt(np.diag(path.covariance[-1]))
print(f"x {x:.2f} +- {std[0]:.2f} m, y {y:.2f} +- {std[1]:.2f} m, yaw {yaw:.2f} +- {std[2]:.2f} rad")
assert yaw < 0.8 * 1.5

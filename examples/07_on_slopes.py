# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""Learning how a vehicle slides on a hillside, and predicting it on another one."""

# A robot across a slope slides downhill, the more, the faster its tyres roll. Roll and pitch in the log are
# all it takes: `auto` then also tries terms of gravity.

# %%
from __future__ import annotations

import numpy as np

import slipwise as sw
from slipwise.ground import Grade
from slipwise_sim import Scenario, simulate
from slipwise_sim.hillside import traverse_drive

hill = Grade(slope=np.radians(8.0), downhill=-1.2)
course = Scenario(duration=200.0, grade=hill, commands=traverse_drive(1, 200.0))
calibration = sw.calibrate(simulate(course, seed=3).log, input="command")
print(calibration.verdict.sentence)
for parameter in calibration.model.content.parameters:
    if "gx" in parameter.name or "gy" in parameter.name:
        print(f"{parameter.name:14} {parameter.value:7.4f} +- {parameter.std:.4f} {parameter.unit}")

# %% [markdown]
# Straight on for 8 s, on level ground and across a steeper slope that falls to the right: there the path
# bends downhill, and it is a path in space.

# %%
across = Grade(slope=np.radians(10.0), downhill=-np.pi / 2)
straight_on = np.array([[0.0, 1.0, 0.0]])  # t, v, omega
level = sw.predict(calibration.model, straight_on, horizon=8.0)
sloping = sw.predict(calibration.model, straight_on, horizon=8.0, ground=across)
for name, path in (("level", level), ("10 degrees", sloping)):
    x, y, z, roll, _, yaw = path.poses_in_space[-1].tolist()
    print(f"{name:10}: x {x:.2f} m, y {y:.2f} m, z {z:.2f} m, roll {roll:.3f} rad, yaw {yaw:.3f} rad")
assert sloping.poses[-1, 1] < level.poses[-1, 1] - 0.1

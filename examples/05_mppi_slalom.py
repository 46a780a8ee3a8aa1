# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""Driving a slalom: the same MPPI controller through the kinematic baseline and through the learned one."""

# The robot answers its commands late and turns less than commanded. A controller that samples thousands of
# futures is only as good as the model that they are driven through.

# %%
from __future__ import annotations

import numpy as np

import slipwise as sw
from slipwise.planning import Controller, Motion, MppiOptions, ReferencePath, baseline_motion, learned_motions
from slipwise_sim import LandTamer, LiveRobot, Scenario, TyreLaw, World, simulate

log = simulate(Scenario(duration=240.0), seed=5).log
model = sw.calibrate(log, input="command").model

# %% [markdown]
# The path, and one drive along it. The controller is called once per period, with the robot's pose and what
# its wheels do.

# %%
x = np.arange(0.0, 16.05, 0.1)
slalom = np.column_stack((x, 1.2 * np.sin(2.0 * np.pi * x / 10.0) * np.clip(x / 3.0, 0.0, 1.0)))
options = MppiOptions(rollouts=1024)


def drive(motions: sw.Model | list[Motion], seconds: float) -> np.ndarray:
    """Follow the slalom; return the cross-track errors [m]."""
    robot = LiveRobot(World(LandTamer(), "tyre-force", TyreLaw()), period=options.period)
    controller = Controller(motions, ReferencePath(slalom, speed=1.0), options=options)
    state, errors = robot.state(), []
    while state.t < seconds and controller.reference.progress < 15.0:
        v, omega = controller.command(state.pose, state.drive)
        state = robot.tell(v, omega)
        errors.append(controller.reference.nearest(state.pose[:2])[1])
    return np.array(errors)


# %% [markdown]
# The baseline sees neither lag nor delay nor slip. `benchmarks/slalom.py` tunes every method alike, and
# adds a vendor's multiplier.

# %%
rms = {}
for name, motions in (("plain", [baseline_motion()]), ("learned", model)):
    errors = drive(motions, 18.0)
    rms[name] = float(np.sqrt(np.mean(errors**2)))
    print(f"{name}: cross-track error {rms[name]:.2f} m rms, {np.abs(errors).max():.2f} m at most")
assert rms["learned"] < 0.5 * rms["plain"]

# %% [markdown]
# Risk: the parameters are not known exactly. With motions drawn from their covariance, and `risk` above 0,
# every sampled sequence is charged for the worst of them.

# %%
careful = Controller(
    learned_motions(model, samples=3),
    ReferencePath(slalom, speed=1.0),
    options=MppiOptions(rollouts=512, risk=0.5),
)
v, omega = careful.command((0.0, 0.0, 0.0), (0.0, 0.0))
print(f"first command with risk: {v:.2f} m/s, {omega:.2f} rad/s")
assert v > 0.0

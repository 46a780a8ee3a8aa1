# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""Planning with a learned model: commands that bring a skidding robot to a pose, and round obstacles."""

# A skid-steered robot commanded to turn at 1 rad/s may turn at 0.6. A planner that believes its commands
# misses the goal; one that plans through the learned model gives commands that arrive there.

# %%
from __future__ import annotations

import math

import numpy as np

import slipwise as sw
from slipwise import planning
from slipwise_sim import LandTamer, LiveRobot, Scenario, TyreLaw, World, simulate

log = simulate(Scenario(duration=240.0), seed=5).log
model = sw.calibrate(log, input="command").model

# %% [markdown]
# One manoeuvre to a pose 6 m ahead and 2 m to the left, facing left. The limits are those that the model
# was learned within.

# %%
goal = (6.0, 2.0, 0.8)
trajectory = planning.trajectory_to(model, goal)
print(
    f"{len(trajectory.commands)} commands, {trajectory.duration:.1f} s, predicted end {trajectory.poses[-1]}"
)
assert math.dist(trajectory.poses[-1][:2], goal[:2]) < 0.01

# %% [markdown]
# Does the robot get there? It drives the commands blindly: it never looks where it is. Beside it, the same
# goal planned as if the robot did what it is commanded.

# %%
PERIOD = 0.02  # s


def drive(commands: np.ndarray, seconds: float) -> tuple[float, float, float]:
    """Drive commands (t, v, omega) on the simulated robot; return its last pose."""
    robot = LiveRobot(World(LandTamer(), "tyre-force", TyreLaw()), period=PERIOD)
    for t in np.arange(0.0, seconds, PERIOD):
        row = np.searchsorted(commands[:, 0], t, side="right") - 1
        robot.tell(*commands[row, 1:].tolist())
    return robot.state().pose


def plain(model: sw.Model) -> sw.Model:
    """Return the model with all slip, lag and delay taken out."""
    content = model.content
    nothing = {"lon": [], "lat": [], "ang": [], "basis": "none"}
    slip = content.slip.model_copy(update=nothing)
    parts = {"slip": slip, "dynamics": False, "clock_offset": False, "response": False}
    return sw.Model(content.model_copy(update={**parts, "parameters": [], "covariance": []}))


errors = {}
for name, believed in (("learned", model), ("plain", plain(model))):
    plan = planning.trajectory_to(believed, goal, limits=planning.limits_of(model))
    end = drive(plan.commands, trajectory.duration)
    errors[name] = math.dist(end[:2], goal[:2])
    print(f"{name}: ends {errors[name]:.2f} m and {abs(end[2] - goal[2]):.2f} rad from the goal")
assert errors["learned"] < 0.5 * errors["plain"]

# %% [markdown]
# Round an obstacle. A map is an array of what is occupied, or a file of ROS's map_server (`load_map`). The
# covariance says how far off the robot may be if it does not look where it is; a route is refused where
# that may be in what is not free. `slipwise plan` does the same from the command line and draws it.

# %%
occupied = np.zeros((200, 200), dtype=bool)
occupied[:60, 95:105] = True
planner = planning.RoutePlanner(
    model, planning.GridMap(occupied, 0.1), search=planning.RouteOptions(radius=0.9, attempts=1500)
)
route = planner.route((3.0, 4.0, 0.5), (16.0, 5.0, -0.5))
spread = math.sqrt(np.linalg.eigvalsh(route.covariance[-1][:2, :2]).max())
print(f"{route.legs} manoeuvres, {route.trajectory.duration:.0f} s, {route.clearance:.2f} m clear")
print(f"at the goal the longest 1-sigma axis is {spread:.2f} m")
assert route.clearance >= 0.0

# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""A camera sees the ground ahead: the robot learns what each look means, and predicts before it is there."""

# First the robot drives on each of three floors, for a minute, three times, and remembers them. Then it goes
# over all of them, by chance, a minute each. A camera names how the ground looks, in words of its own; nobody
# says which look is which floor, nor which floor is driven on.

# %%
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import slipwise as sw
from slipwise.errors import ModelError
from slipwise.prediction import predict
from slipwise.terrain_ahead import TerrainAhead

LOOKS = ("bright", "dark", "green")
YAW_SLIP = (0.05, 0.3, 0.6)  # fraction of its turn that the robot loses on each floor
VISIT, STEP, HOLD = 60.0, 0.05, 2.0  # s on a floor, between samples, that a speed is held
VISITS, TAUGHT = 30, 9  # the first ones are drives of their own, and not counted


@dataclass(frozen=True)
class World:
    """A drive: wheel speeds, true poses, and the floor of each visit."""

    floors: list[int]
    t: np.ndarray
    wheels: np.ndarray  # [N, 2] m/s, rad/s, held until the next
    poses: np.ndarray  # [N, 3]


def made_world(seed: int) -> World:
    """Return a drive over floors, each another than the one before."""
    rng = np.random.default_rng(seed)
    floors = [0, 1, 2] * 3
    while len(floors) < VISITS:
        floors.append(int(rng.choice([floor for floor in range(3) if floor != floors[-1]])))
    count, every = int(VISITS * VISIT / STEP), int(HOLD / STEP)
    t = STEP * np.arange(count)
    held = np.column_stack(
        (rng.uniform(0.4, 1.0, count), rng.choice([-1, 1], count) * rng.uniform(0.3, 0.8, count))
    )
    wheels = held[np.arange(count) // every * every]
    pose, poses = np.zeros(3), np.zeros((count, 3))
    for k in range(count):
        poses[k] = pose
        lost = YAW_SLIP[floors[int(t[k] // VISIT)]] + 0.03 * rng.standard_normal()
        turn, length = (1.0 - lost) * wheels[k, 1] * STEP, 0.97 * wheels[k, 0] * STEP
        along = pose[2] + turn / 2
        pose = pose + np.array([length * np.cos(along), length * np.sin(along), turn])
    return World(floors, t, wheels, poses)


def said_of(floors: list[int], wrong: float, seed: int) -> list[str]:
    """Return how the camera names each visit's ground; in a share of visits it names another look."""
    rng = np.random.default_rng(seed)
    other = [int(rng.choice([k for k in range(3) if k != floor])) for floor in floors]
    return [LOOKS[o if rng.random() < wrong else floor] for floor, o in zip(floors, other, strict=True)]


# %% [markdown]
# At each edge the next two seconds are predicted, then each second that follows. With a camera, the
# prediction at the edge knows how the ground looks there, and the learner is told as soon as it is driven on.


# %%
def errors_after_edges(world: World, looks: list[str] | None) -> np.ndarray:
    """Return the heading's error [rad] of predictions at the edge and 1, 2, ... s after it, a visit a row."""
    rng, learner = np.random.default_rng(7), sw.MotionLearner("wheel", remember=True)
    rows: list[list[float]] = []
    per_second = int(1.0 / STEP)
    for k, (t, pose) in enumerate(zip(world.t.tolist(), world.poses, strict=True)):
        visit, since = divmod(k, int(VISIT / STEP))
        if since == 0 and visit <= TAUGHT:
            learner.start_drive(f"drive {visit}")
        learner.push_wheels(t, *world.wheels[k].tolist())
        if k % 2 == 0:
            x, y, yaw = pose + rng.standard_normal(3) * [0.005, 0.005, 0.003]
            learner.push_pose(t, float(x), float(y), float(yaw))
        if since == 0 and visit > TAUGHT:
            rows.append([edge_error(learner, world, k, looks[visit] if looks else None)])
        if since == 0 and looks:
            learner.cue_terrain({look: float(look == looks[visit]) for look in LOOKS})
        if 0 < since <= 8 * per_second and since % per_second == 0 and visit > TAUGHT:
            path = learner.predict(future(world, k, 1.0), horizon=1.0)
            rows[-1].append(abs(path.poses[-1, 2] - turned(world, k, 1.0)))
    return np.array(rows)


def edge_error(learner: sw.MotionLearner, world: World, k: int, look: str | None) -> float:
    """Return the error over the 2 s after an edge, with what is seen beyond it or without."""
    ahead = None if look is None else TerrainAhead([0.0], {look: 1.0}, classes=True)
    model, commands = learner.model(limits=False), future(world, k, 2.0)
    try:
        path = predict(model, commands, horizon=2.0, terrain_ahead=ahead)
    except ModelError:  # nothing is remembered yet
        path = predict(model, commands, horizon=2.0)
    return abs(float(path.poses[-1, 2]) - turned(world, k, 2.0))


def future(world: World, k: int, seconds: float) -> np.ndarray:
    """Return the wheel speeds that will be given."""
    rows = slice(k, k + int(seconds / STEP))
    return np.column_stack((world.t[rows], world.wheels[rows]))


def turned(world: World, k: int, seconds: float) -> float:
    """Return how far the robot truly turned [rad]."""
    end = min(k + int(seconds / STEP), len(world.t) - 1)
    return float(world.poses[end, 2] - world.poses[k, 2])


world = made_world(seed=1)
means = {}
for name, wrong in (("no camera", None), ("a camera", 0.0), ("wrong in 20 %", 0.2)):
    looks = None if wrong is None else said_of(world.floors, wrong, seed=2)
    means[name] = np.degrees(errors_after_edges(world, looks)).mean(axis=0)
print("mean error of the heading [deg]   at the edge, 2 s   1 s windows 1 to 8 s after it")
for name, mean in means.items():
    print(f"{name:33} {mean[0]:17.2f}   {' '.join(f'{each:.2f}' for each in mean[1:])}")
assert means["a camera"][0] < 0.5 * means["no camera"][0]
assert means["wrong in 20 %"][0] < means["no camera"][0]

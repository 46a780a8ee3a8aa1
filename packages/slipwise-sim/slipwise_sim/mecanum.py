# SPDX-License-Identifier: Apache-2.0
"""A mecanum platform with every roller of its wheels, in MuJoCo: it drives ahead, sideways and turns."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.log import Inputs, Log, Poses, Run
from slipwise_sim.engine import load_mujoco
from slipwise_sim.physics import planar_truth

Floats = NDArray[np.float64]

STEP = 0.001  # s, of the physics; rollers are small
SETTLING_TIME = 0.5  # s at rest
_QUARTER = math.pi / 4.0


@dataclass(frozen=True)
class MecanumPlatform:
    """Sizes, and how well wheels grip: with little friction or damped rollers it slips more."""

    length: float = 0.5  # m between the axles
    width: float = 0.45  # m between the left and the right wheels
    radius: float = 0.1  # m, of a wheel
    roller_radius: float = 0.02  # m, in the middle of a roller
    rollers: int = 10  # of a wheel
    mass: float = 20.0  # kg
    friction: float = 0.7  # of rollers on the ground
    roller_damping: float = 2e-3  # N m s/rad, what turning a roller costs: the platform creeps
    centre_of_mass: tuple[float, float] = (0.05, 0.0)  # m ahead of the middle, to the left

    def layout(self) -> _core.WheelLayout:
        """Return the wheels as the core knows them: front left, front right, rear left, rear right."""
        return _core.WheelLayout(
            [
                _core.Wheel(x, y, self.radius, 0.0, angle, steered=False, behind_hinge=False, pivot=None)
                for x, y, angle in self.places()
            ],
            rolling=0.02,
            sideways=0.02,
            hinge=None,
        )

    def places(self) -> list[tuple[float, float, float]]:
        """Return x, y [m] and the angle of the rollers' axes to the wheel's direction [rad] of each wheel."""
        ahead, left = self.length / 2.0, self.width / 2.0
        return [
            (ahead, left, -_QUARTER),
            (ahead, -left, _QUARTER),
            (-ahead, left, _QUARTER),
            (-ahead, -left, -_QUARTER),
        ]


def mecanum_log(
    platform: MecanumPlatform,
    commands: Inputs,
    *,
    pose_noise: tuple[float, float] = (0.002, 0.001),
    seed: int = 1,
) -> Log:
    """Drive the platform and return a log of commands and poses; each command goes to the wheels at once.

    Args:
        platform: what drives.
        commands: twists, held until the next one.
        pose_noise: standard deviations of x and y [m], and of yaw [rad].
        seed: of the noise.

    Raises:
        SlipwiseError: MuJoCo is not installed, or the physics became unstable.
    """
    mujoco = load_mujoco()
    model = mujoco.MjModel.from_xml_string(mecanum_mjcf(platform))
    data = mujoco.MjData(model)
    for _ in range(round(SETTLING_TIME / STEP)):
        mujoco.mj_step(model, data)
    begin = data.time
    twists = np.column_stack((commands.v, commands.vy, commands.omega))
    targets, _ = platform.layout().wheels_for(twists)
    position, velocity = np.empty((len(commands), model.nq)), np.empty((len(commands), model.nv))
    for k, rates in enumerate(targets):
        position[k], velocity[k] = data.qpos, data.qvel
        data.ctrl = rates
        until = begin + (float(commands.t[k + 1]) if k + 1 < len(commands) else float(commands.t[k]))
        while data.time < until - STEP / 2.0:
            mujoco.mj_step(model, data)
    truth = planar_truth(commands.t, position, velocity, np.zeros((len(commands), 2)))
    rng, (std, yaw_std) = np.random.default_rng(seed), pose_noise
    x, y = (values + rng.normal(0.0, std, len(values)) for values in (truth.x, truth.y))
    yaw = truth.yaw + rng.normal(0.0, yaw_std, len(truth.yaw))
    frame = np.zeros(len(commands), np.int64)
    run = Run("mecanum", commands, None, Poses(t=commands.t, x=x, y=y, yaw=yaw, frame=frame))
    return Log((run,), notes=("simulated: a mecanum platform in MuJoCo",), sideways=True)


def mecanum_mjcf(platform: MecanumPlatform) -> str:
    """Return the MJCF of the platform on a plane."""
    x, y = platform.centre_of_mass
    wheels = "".join(_wheel(platform, k, *place) for k, place in enumerate(platform.places()))
    drives = "".join(f'<velocity joint="spin{k}" kv="20"/>' for k in range(len(platform.places())))
    return f"""<mujoco>
  <option timestep="{STEP}" integrator="implicitfast" cone="elliptic" impratio="10"/>
  <default><geom friction="{platform.friction} 0 0" condim="3"/></default>
  <worldbody>
    <geom type="plane" size="0 0 1" contype="2" conaffinity="1"/>
    <body name="base" pos="0 0 {platform.radius + 0.002}">
      <freejoint/>
      <geom type="box" size="{platform.length / 2} {platform.width / 3} 0.03" pos="{x} {y} 0.02"
        mass="{platform.mass}" contype="0" conaffinity="0"/>
      {wheels}
    </body>
  </worldbody>
  <actuator>{drives}</actuator>
</mujoco>"""


def _wheel(platform: MecanumPlatform, number: int, x: float, y: float, angle: float) -> str:
    """A hub and its rollers: ellipsoids that have the curvature of the wheel along their axes."""
    across = platform.radius - platform.roller_radius
    # A line at 45 degrees on a cylinder has twice its radius: semi-axis sqrt(2 R r).
    half = math.sqrt(2.0 * platform.radius * platform.roller_radius)
    rollers = "".join(
        f"""<body pos="{across * math.sin(phi)} 0 {-across * math.cos(phi)}"
            xyaxes="{_row(_axes(phi, angle))}">
          <joint type="hinge" axis="1 0 0" damping="{platform.roller_damping}" armature="1e-5"/>
          <geom type="ellipsoid" size="{half} {platform.roller_radius} {platform.roller_radius}"
            mass="0.05" contype="1" conaffinity="2"/>
        </body>"""
        for phi in (2.0 * math.pi * np.arange(platform.rollers) / platform.rollers).tolist()
    )
    return f"""<body pos="{x} {y} 0">
        <joint name="spin{number}" type="hinge" axis="0 1 0" armature="0.01"/>
        <geom type="cylinder" size="{across / 2} 0.02" euler="90 0 0" mass="0.5"
          contype="0" conaffinity="0"/>
        {rollers}
      </body>"""


def _axes(phi: float, angle: float) -> Floats:
    """The x and y axis of a roller that is `phi` round the wheel from the ground: x is what it turns about.

    On the ground a roller's axis lies at `angle` to the wheel's direction.
    """
    ahead = np.array([math.cos(phi), 0.0, math.sin(phi)])  # along the rim
    along = math.cos(angle) * ahead + math.sin(angle) * np.array([0.0, 1.0, 0.0])
    out = np.array([math.sin(phi), 0.0, -math.cos(phi)])
    return np.concatenate((along, np.cross(out, along)))


def _row(values: Floats) -> str:
    return " ".join(f"{value:.9g}" for value in values)

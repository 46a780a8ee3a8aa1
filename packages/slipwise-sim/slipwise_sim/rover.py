# SPDX-License-Identifier: Apache-2.0
"""Vehicles on steered wheels as MuJoCo models: a six-wheel rocker-bogie rover, and a swerve base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.logs.vehicle_description import VehicleDescription, WheelDescription
from slipwise_sim.land_tamer import GRAVITY

STEP = 0.002  # s, of the physics


@dataclass(frozen=True)
class Rover:
    """A vehicle on steered wheels; what is stated of it may differ from what is simulated by `wear`.

    With `bogies`, each side has a rocker that turns about the chassis. It carries the front wheel, and behind
    it a bogie with the middle and the rear wheel. A differential turns one rocker against the other.
    """

    length: float = 0.534  # m between the front and the rear wheels
    width: float = 0.368  # m between the left and the right corner wheels
    middle_width: float = 0.511  # m between the middle wheels
    radius: float = 0.075  # m of a wheel, as stated
    wear: float = 0.05  # part of the stated radius by which wheels are smaller in truth
    height: float = 0.2  # m, of the chassis over the ground
    mass: float = 8.0  # kg, of the chassis
    wheel_mass: float = 0.4  # kg
    bogies: bool = True  # six wheels on rockers and bogies; otherwise four on a stiff frame
    friction: float = 0.8  # of wheels on the ground
    drag: float = 0.02  # N m s/rad, what turning a wheel costs
    steering_gain: float = 8.0  # N m/rad

    @property
    def wheels(self) -> list[tuple[str, float, float, bool]]:
        """Name, x, y [m] and whether it is steered, of each wheel."""
        ahead, left = self.length / 2.0, self.width / 2.0
        found = [
            (end + side, x, y, True)
            for end, x in (("f", ahead), ("r", -ahead))
            for side, y in (("l", left), ("r", -left))
        ]
        if self.bogies:
            middle = self.middle_width / 2.0
            found += [("ml", 0.0, middle, False), ("mr", 0.0, -middle, False)]
        return found

    def description(self) -> VehicleDescription:
        """Return the vehicle as its maker states it: nothing of wear."""
        wheels = [
            WheelDescription(name=name, x=x, y=y, radius=self.radius, steer=name if steered else None)
            for name, x, y, steered in self.wheels
        ]
        return VehicleDescription(source="simulated", wheels=wheels)


@dataclass(frozen=True)
class RoughGround:
    """A plane with scattered stones: caps of spheres that are sunk into it."""

    stones: int = 0
    height: float = 0.03  # m, the highest of them
    extent: float = 5.0  # m from the origin to where the last ones lie
    seed: int = 1

    def mjcf(self) -> str:
        """Return the ground's geoms."""
        rng = np.random.default_rng(self.seed)
        text = (
            '<geom name="ground" type="plane" size="0 0 .1" material="ground" contype="2" conaffinity="1"/>'
        )
        for _ in range(self.stones):
            x, y = rng.uniform(-self.extent, self.extent, 2)
            high, ball = rng.uniform(0.3, 1.0) * self.height, rng.uniform(0.15, 0.5)
            text += (
                f'<geom type="sphere" size="{ball:.4f}" pos="{x:.4f} {y:.4f} {high - ball:.4f}"'
                ' rgba=".55 .42 .33 1" contype="2" conaffinity="1"/>'
            )
        return text


def rover_mjcf(rover: Rover, ground: RoughGround) -> str:
    """Return the vehicle on its ground as MuJoCo XML.

    A wheel meets the ground as a ball of its radius, like a tyre with a round profile; a drum is drawn.
    """
    steers = "".join(
        f'<position joint="steer_{name}" kp="{rover.steering_gain}" kv="0.6"/>'
        for name, _, _, steered in rover.wheels
        if steered
    )
    spins = "".join(f'<velocity joint="spin_{name}" kv="2"/>' for name, *_ in rover.wheels)
    same = '<equality><joint joint1="rocker_l" joint2="rocker_r" polycoef="0 -1 0 0 0"/></equality>'
    return f"""<mujoco model="rover">
  <option timestep="{STEP}" gravity="0 0 {-GRAVITY}" integrator="implicitfast" cone="elliptic" impratio="10"/>
  <visual><global offwidth="1280" offheight="720"/></visual>
  <default><geom friction="{rover.friction} 0.005 0.0001" condim="3"/></default>
  <asset>
    <texture name="ground" type="2d" builtin="checker" rgb1=".72 .56 .42" rgb2=".66 .5 .37"
      width="256" height="256"/>
    <material name="ground" texture="ground" texrepeat="2 2" texuniform="true"/>
    <texture type="skybox" builtin="gradient" rgb1=".85 .75 .65" rgb2="1 1 1" width="128" height="128"/>
  </asset>
  <worldbody>
    <light pos="-4 -4 12" dir=".3 .3 -1" diffuse=".8 .8 .8" castshadow="true"/>
    {ground.mjcf()}
    <body name="chassis" pos="0 0 {rover.height + 0.01}">
      <freejoint/>
      <geom type="box" size="{rover.length / 3:.4f} {rover.width / 3:.4f} .05" pos="0 0 .03"
        mass="{rover.mass}" rgba=".9 .88 .82 1" contype="0" conaffinity="0"/>
      <camera name="chase" pos="-1.1 -1.3 .75" xyaxes=".76 -.65 0 .27 .31 .91" mode="trackcom"/>
      {_sides(rover)}
    </body>
  </worldbody>
  {same if rover.bogies else ""}
  <actuator>{steers}{spins}</actuator>
</mujoco>"""


def _sides(rover: Rover) -> str:
    places = {name: (x, y, steered) for name, x, y, steered in rover.wheels}
    below = rover.radius * (1.0 - rover.wear) - rover.height  # of the hubs, to the chassis
    if not rover.bogies:
        frame = "".join(_bar((x, 0.0, 0.0), (x, y, 0.0)) for x, y, _ in places.values())
        return frame + "".join(_wheel(rover, name, (x, y, below), s) for name, (x, y, s) in places.items())
    text = ""
    for side, sign in (("l", 1.0), ("r", -1.0)):
        y = sign * rover.width / 2.0
        x = -rover.length / 4.0  # of the bogie's joint: half way between its wheels
        hub = below / 2.0
        front, middle, rear = (places[part + side] for part in "fmr")
        text += f"""
      <body name="rocker_{side}" pos="0 {y} 0">
        <joint name="rocker_{side}" type="hinge" axis="0 1 0" damping=".3"/>
        {_bar((0.0, 0.0, 0.0), (front[0], front[1] - y, below))}{_bar((0.0, 0.0, 0.0), (x, 0.0, hub))}
        {_wheel(rover, "f" + side, (front[0], front[1] - y, below), front[2])}
        <body name="bogie_{side}" pos="{x} 0 {hub}">
          <joint name="bogie_{side}" type="hinge" axis="0 1 0" damping=".1"/>
          {_bar((0.0, 0.0, 0.0), (middle[0] - x, middle[1] - y, below - hub))}
          {_bar((0.0, 0.0, 0.0), (rear[0] - x, rear[1] - y, below - hub))}
          {_wheel(rover, "m" + side, (middle[0] - x, middle[1] - y, below - hub), middle[2])}
          {_wheel(rover, "r" + side, (rear[0] - x, rear[1] - y, below - hub), rear[2])}
        </body>
      </body>"""
    return text


def _bar(begin: tuple[float, float, float], end: tuple[float, float, float]) -> str:
    points = " ".join(f"{value:.5f}" for value in (*begin, *end))
    return (
        f'<geom type="capsule" fromto="{points}" size=".012" mass=".2" rgba=".3 .3 .32 1"'
        ' contype="0" conaffinity="0"/>'
    )


def _wheel(rover: Rover, name: str, at: tuple[float, float, float], steered: bool) -> str:
    radius = rover.radius * (1.0 - rover.wear)
    fork = radius * 1.3 if rover.bogies else -at[2]
    # Every wheel turns in a fork, so that steered ones and others weigh the same.
    joint = f'<joint name="steer_{name}" type="hinge" axis="0 0 1" armature=".002"/>' if steered else ""
    drawn = 'rgba=".15 .15 .15 1" contype="0" conaffinity="0"'
    return f"""
      <body pos="{at[0]:.5f} {at[1]:.5f} {at[2]:.5f}">{joint}
        <geom type="capsule" fromto="0 0 0 0 0 {fork:.5f}" size=".01" mass=".1" rgba=".3 .3 .32 1"
          contype="0" conaffinity="0"/>
        <body>
          <joint name="spin_{name}" type="hinge" axis="0 1 0" armature=".005" damping="{rover.drag}"/>
          <geom type="sphere" size="{radius:.5f}" mass="{rover.wheel_mass}" rgba="0 0 0 0"
            contype="1" conaffinity="2"/>
          <geom type="cylinder" size="{radius:.5f} {radius / 2:.5f}" zaxis="0 1 0" mass=".001" {drawn}/>
        </body>
      </body>"""


def swerve_base() -> Rover:
    """Return a base whose four wheels are all steered: it drives every way."""
    return Rover(length=0.5, width=0.36, radius=0.1, height=0.22, mass=20.0, bogies=False, steering_gain=20.0)

# SPDX-License-Identifier: Apache-2.0
"""The Land Tamer of the thesis: a six-wheel, 1000 kg, skid-steered vehicle with hydraulic side drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.kinematics import twist_from_wheels

GRAVITY = 9.81  # [m/s^2]


@dataclass(frozen=True)
class LandTamer:
    """The vehicle's constants; every one is stated here and nowhere else.

    Delay and lag are those published for the vehicle (Seegmiller et al., IJRR 2013; the thesis gives none);
    the rest are plausible for its size.
    Wheels are numbered front left, front right, middle left, middle right, rear left, rear right.
    """

    mass: float = 1000.0  # [kg] of the whole vehicle
    wheel_mass: float = 25.0  # [kg] of one wheel
    wheel_radius: float = 0.30  # [m]
    wheel_width: float = 0.25  # [m]
    wheel_armature: float = 1.0  # [kg m^2] drive train inertia felt by one wheel
    wheel_separation: float = 1.30  # [m] between the contact patches of the two sides
    axles: tuple[float, ...] = (0.85, 0.0, -0.85)  # [m] forward of the vehicle's origin
    ground_clearance: float = 0.17  # [m] from hub height to the vehicle's origin
    hull_size: tuple[float, float, float] = (2.5, 0.9, 0.5)  # [m] length, width, height
    suspension_stiffness: float = 60000.0  # [N/m] at one wheel
    suspension_damping: float = 3000.0  # [N s/m] at one wheel
    suspension_travel: float = 0.12  # [m] up and down
    command_delay: float = 0.16  # [s] from command to hydraulic valve
    command_lag: float = 0.81  # [s] time constant of a side's speed
    drive_gain: float = 10000.0  # [N m s/rad] torque per speed error of one wheel
    drive_torque_limit: float = 900.0  # [N m] at one wheel
    wheel_damping: float = 1.0  # [N m s/rad] bearing drag of one wheel

    @property
    def wheel_places(self) -> NDArray[np.float64]:
        """Forward and leftward position of each wheel, [m], shape [wheels, 2]."""
        side = (self.wheel_separation / 2, -self.wheel_separation / 2)
        return np.array([(axle, y) for axle in self.axles for y in side])

    def side_rates(self, v: NDArray[np.float64], omega: NDArray[np.float64]) -> NDArray[np.float64]:
        """Wheel rates that a twist asks for on ideal terrain.

        Args:
            v: forward speed [m/s], shape [N].
            omega: yaw rate [rad/s], shape [N].

        Returns:
            Left and right wheel rate [rad/s], shape [N, 2].
        """
        half = omega * self.wheel_separation / 2
        return np.stack([v - half, v + half], axis=-1) / self.wheel_radius

    def odometry(
        self, left: NDArray[np.float64], right: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Forward speed [m/s] and yaw rate [rad/s] that wheel rates [rad/s] would give on ideal terrain."""
        return twist_from_wheels(
            left, right, wheel_radius=self.wheel_radius, wheel_separation=self.wheel_separation
        )


def wheel_names(vehicle: LandTamer) -> tuple[str, ...]:
    """Names of the wheels in the order of `LandTamer.wheel_places`: l0, r0, l1, ..."""
    return tuple(f"{side}{axle}" for axle in range(len(vehicle.axles)) for side in "lr")


def mjcf(
    vehicle: LandTamer,
    *,
    time_step: float,
    friction: float | None,
    gravity: tuple[float, float, float] = (0.0, 0.0, -GRAVITY),
) -> str:
    """Return the vehicle on a plane as MuJoCo XML.

    Each wheel is an ellipsoid (one smooth contact) on a sprung slide, and turned by a velocity servo whose
    activation is the first-order lag of the side drive. Without a suspension three axles are hyperstatic, and
    the wheel loads become arbitrary. A touch sensor measures each wheel's normal load.

    Args:
        vehicle: the constants.
        time_step: simulation step [s].
        friction: friction coefficient of the contacts, or None for frictionless ones.
        gravity: in the frame of the plane [m/s^2]; it leans where the plane is a hillside.
    """
    contact, cone = 'condim="1"', "pyramidal"
    if friction is not None:
        contact, cone = f'condim="3" friction="{friction} {friction} 0.005 0.0001 0.0001"', "elliptic"
    names = wheel_names(vehicle)
    places = vehicle.wheel_places.tolist()
    wheels = "".join(_wheel(vehicle, name, x, y) for name, (x, y) in zip(names, places, strict=True))
    pairs = "".join(f'<pair geom1="wheel_{name}" geom2="terrain" {contact}/>' for name in names)
    drives = "".join(_drive(vehicle, name) for name in names)
    loads = "".join(f'<touch name="load_{name}" site="patch_{name}"/>' for name in names)
    length, width, height = (size / 2 for size in vehicle.hull_size)
    hull_mass = vehicle.mass - len(names) * vehicle.wheel_mass
    x, y, z = gravity
    return f"""<mujoco model="land_tamer">
  <option timestep="{time_step!r}" gravity="{x} {y} {z}" integrator="implicitfast" cone="{cone}"
          impratio="10" iterations="30"><flag autoreset="disable"/></option>
  <visual><global offwidth="1280" offheight="720"/></visual>
  <asset>
    <texture name="terrain" type="2d" builtin="checker" rgb1=".55 .5 .4" rgb2=".45 .4 .32"
             width="256" height="256"/>
    <material name="terrain" texture="terrain" texrepeat=".5 .5" texuniform="true"/>
    <texture type="skybox" builtin="gradient" rgb1=".6 .75 .95" rgb2="1 1 1" width="128" height="128"/>
  </asset>
  <worldbody>
    <light pos="0 0 20" dir="0 0 -1" diffuse=".8 .8 .8"/>
    <geom name="terrain" type="plane" size="0 0 .1" material="terrain" contype="0" conaffinity="0"/>
    <body name="hull" pos="0 0 {vehicle.wheel_radius + vehicle.ground_clearance}">
      <freejoint name="root"/>
      <geom name="hull" type="box" size="{length} {width} {height}" pos="0 0 .1" mass="{hull_mass}"
            rgba=".8 .6 .1 1" contype="0" conaffinity="0"/>
      <camera name="chase" pos="-6 -5 4" xyaxes=".64 -.77 0 .3 .25 .92" mode="trackcom"/>
      {wheels}
    </body>
  </worldbody>
  <contact>{pairs}</contact>
  <actuator>{drives}</actuator>
  <sensor>{loads}</sensor>
</mujoco>"""


def _wheel(vehicle: LandTamer, name: str, x: float, y: float) -> str:
    radius, half_width = vehicle.wheel_radius, vehicle.wheel_width / 2
    count = len(vehicle.axles) * 2
    balance = -(vehicle.mass / count - vehicle.wheel_mass) * GRAVITY / vehicle.suspension_stiffness
    return f"""
      <body name="wheel_{name}" pos="{x} {y} {-vehicle.ground_clearance}">
        <joint name="suspension_{name}" type="slide" axis="0 0 1" stiffness="{vehicle.suspension_stiffness}"
               damping="{vehicle.suspension_damping}" springref="{balance!r}"
               range="{-vehicle.suspension_travel} {vehicle.suspension_travel}" limited="true"/>
        <joint name="spin_{name}" type="hinge" axis="0 1 0" damping="{vehicle.wheel_damping}"
               armature="{vehicle.wheel_armature}"/>
        <geom name="wheel_{name}" type="ellipsoid" size="{radius} {half_width} {radius}"
              mass="{vehicle.wheel_mass}" rgba=".1 .1 .1 1" contype="0" conaffinity="0"/>
        <site name="patch_{name}" type="sphere" size="{1.3 * radius}" rgba="0 0 0 0"/>
      </body>"""


def _drive(vehicle: LandTamer, name: str) -> str:
    gain, limit = vehicle.drive_gain, vehicle.drive_torque_limit
    return f"""
    <general name="drive_{name}" joint="spin_{name}" dyntype="filterexact" dynprm="{vehicle.command_lag}"
             gaintype="fixed" gainprm="{gain}" biastype="affine" biasprm="0 0 {-gain}"
             forcelimited="true" forcerange="{-limit} {limit}"/>"""

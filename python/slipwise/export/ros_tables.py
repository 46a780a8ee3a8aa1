# SPDX-License-Identifier: Apache-2.0
"""Parameters of ROS nodes as data: name, type, unit, the releases that have it, how a new value takes effect.

Read in ros2_controllers at 94e74de (August 2026), Nav2 at a3a97043 and its branches jazzy, kilted and
lyrical, robot_localization at 1cb9533.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from slipwise.errors import ModelError

DISTROS = ("humble", "jazzy", "kilted", "lyrical", "rolling")  # in the order of time
OPTION = "--ros-distro"

Kind = Literal["bool", "double", "string", "bool_array", "double_array"]
Effect = Literal["at once", "at a restart"]


@dataclass(frozen=True)
class RosParameter:
    """One parameter of a node in some releases of ROS."""

    name: str  # below the node, or below the name of a plug-in
    kind: Kind
    unit: str
    effect: Effect  # how a running node takes a new value
    since: str = "humble"
    until: str = "rolling"
    limit: bool = False  # it bounds what the robot may do: never handed on unasked

    def valid_in(self, distro: str) -> bool:
        """Whether the release has it so."""
        return DISTROS.index(self.since) <= DISTROS.index(distro) <= DISTROS.index(self.until)


@dataclass(frozen=True)
class RosTable:
    """The parameters of one target that slipwise writes."""

    target: str
    prefix: str  # of a plug-in's name, such as "FollowPath."
    parameters: tuple[RosParameter, ...]
    no_callback: str = ""  # why setting parameters of a running node does nothing

    def of_distro(self, distro: str | None) -> dict[str, RosParameter]:
        """Return the parameters by their full names; without a release those that all have alike."""
        return {
            f"{self.prefix}{each.name}": each
            for each in self.parameters
            if (each.valid_in(distro) if distro else (each.since, each.until) == (DISTROS[0], DISTROS[-1]))
        }

    @property
    def differs(self) -> bool:
        """Whether releases have different parameters."""
        return len(self.of_distro(None)) < len(self.parameters)


def checked_distro(distro: str | None, what: str) -> str:
    """Return the release of ROS that a file is for; none is guessed.

    Raises:
        ModelError: it is not named, or the tables do not hold it.
    """
    if distro is not None and distro not in DISTROS:
        raise ModelError(
            f"no table of parameters for ROS '{distro}'",
            advice=f"{OPTION}, or $ROS_DISTRO: one of {', '.join(DISTROS)}",
        )
    if distro is None:
        raise ModelError(
            f"the parameters of {what} differ between ROS releases",
            advice=f"add {OPTION} {' or '.join(DISTROS)}, or set $ROS_DISTRO",
        )
    return distro


def _velocity_limits(effect: Effect, since: str, until: str) -> tuple[RosParameter, ...]:
    named = (
        ("linear.x.max_velocity", "m/s"),
        ("linear.x.min_velocity", "m/s"),
        ("angular.z.max_velocity", "rad/s"),
        ("angular.z.min_velocity", "rad/s"),
    )
    return tuple(RosParameter(name, "double", unit, effect, since, until, limit=True) for name, unit in named)


DIFF_DRIVE = RosTable(
    "diff-drive",
    "",
    (
        RosParameter("wheel_separation", "double", "m", "at a restart"),
        RosParameter("wheel_separation_multiplier", "double", "-", "at a restart"),
        RosParameter("left_wheel_radius_multiplier", "double", "-", "at a restart"),
        RosParameter("right_wheel_radius_multiplier", "double", "-", "at a restart"),
        RosParameter("twist_covariance_diagonal", "double_array", "m^2/s^2, rad^2/s^2", "at a restart"),
        RosParameter("pose_covariance_diagonal", "double_array", "m^2, rad^2", "at a restart"),
        RosParameter("publish_rate", "double", "Hz", "at a restart", until="kilted"),  # gone with #2259
        RosParameter("linear.x.has_velocity_limits", "bool", "-", "at a restart", until="humble", limit=True),
        RosParameter(
            "angular.z.has_velocity_limits", "bool", "-", "at a restart", until="humble", limit=True
        ),
        *_velocity_limits("at a restart", "humble", "kilted"),
        *_velocity_limits("at once", "lyrical", "rolling"),  # dynamic since #2293
    ),
)

MPPI = RosTable(
    "mppi",
    "FollowPath.",  # the name that Nav2's own parameter file gives the controller
    (
        RosParameter("motion_model", "string", "-", "at a restart"),
        RosParameter("diff_drive.plugin", "string", "-", "at a restart", since="lyrical"),
        RosParameter("ackermann.plugin", "string", "-", "at a restart", since="lyrical"),
        RosParameter("ackermann.min_turning_r", "double", "m", "at once", since="lyrical"),
        RosParameter("AckermannConstraints.min_turning_r", "double", "m", "at once", until="kilted"),
        RosParameter("model_delay_vx", "double", "s", "at once", since="lyrical"),  # #6154
        RosParameter("model_delay_wz", "double", "s", "at once", since="lyrical"),
        RosParameter("vx_max", "double", "m/s", "at once", limit=True),
        RosParameter("vx_min", "double", "m/s", "at once", limit=True),
        RosParameter("wz_max", "double", "rad/s", "at once", limit=True),
        RosParameter("ax_max", "double", "m/s^2", "at once", since="jazzy", limit=True),
        RosParameter("ax_min", "double", "m/s^2", "at once", since="jazzy", limit=True),
        RosParameter("az_max", "double", "rad/s^2", "at once", since="jazzy", limit=True),
        RosParameter(
            "VelocityDeadbandCritic.deadband_velocities",
            "double_array",
            "m/s, m/s, rad/s",
            "at once",
            since="jazzy",
        ),
    ),
)

#: What `motion_model` is called, and its plug-in; a release that does not know the name does not configure.
MOTION_MODELS = {
    ("diff-drive", "kilted"): ("DiffDrive", ""),
    ("ackermann", "kilted"): ("Ackermann", ""),
    ("diff-drive", "rolling"): ("diff_drive", "mppi::DiffDriveMotionModel"),
    ("ackermann", "rolling"): ("ackermann", "mppi::AckermannMotionModel"),
}


def motion_model(kind: str, distro: str) -> tuple[str, str]:
    """Return the name of a kind of vehicle in a release, and its plug-in where it needs one."""
    until = "kilted" if DISTROS.index(distro) <= DISTROS.index("kilted") else "rolling"
    return MOTION_MODELS[kind, until]


AMCL = RosTable(
    "amcl",
    "",
    (
        RosParameter("robot_model_type", "string", "-", "at a restart"),
        RosParameter("update_min_d", "double", "m", "at a restart"),
        RosParameter("update_min_a", "double", "rad", "at a restart"),
        RosParameter("alpha1", "double", "-", "at once"),
        RosParameter("alpha2", "double", "rad^2/m^2", "at once"),
        RosParameter("alpha3", "double", "-", "at once"),
        RosParameter("alpha4", "double", "m^2/rad^2", "at once"),
        RosParameter("alpha5", "double", "-", "at once"),
    ),
)

ROBOT_LOCALIZATION = RosTable(
    "robot-localization",
    "",
    (
        RosParameter("frequency", "double", "Hz", "at a restart"),
        RosParameter("two_d_mode", "bool", "-", "at a restart"),
        RosParameter("dynamic_process_noise_covariance", "bool", "-", "at a restart"),
        RosParameter("process_noise_covariance", "double_array", "m^2, rad^2 by speed^2", "at a restart"),
        RosParameter("use_control", "bool", "-", "at a restart"),
        RosParameter("stamped_control", "bool", "-", "at a restart"),
        RosParameter("control_config", "bool_array", "-", "at a restart"),
        RosParameter("acceleration_gains", "double_array", "1/s", "at a restart"),
        RosParameter("deceleration_gains", "double_array", "1/s", "at a restart"),
        RosParameter("acceleration_limits", "double_array", "m/s^2, rad/s^2", "at a restart"),
        RosParameter("deceleration_limits", "double_array", "m/s^2, rad/s^2", "at a restart"),
    ),
    no_callback="the filter has no parameter callback: it would answer success and keep its old values",
)

TABLES = {table.target: table for table in (DIFF_DRIVE, MPPI, AMCL, ROBOT_LOCALIZATION)}

# SPDX-License-Identifier: Apache-2.0
"""The part of the settings that `slipwise live` reads; it changes nothing of how a log is learned."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Seconds = Annotated[float, Field(gt=0.0, le=1e6)]
Transports = Literal["ros", "rclpy", "cyclonedds", "stdin", "udp"]
ApplyMode = Literal["off", "manual", "auto"]
TARGET_NODES = {  # whose parameters are set where none is named
    "diff-drive": "/diff_drive_controller",
    "mppi": "/controller_server",
    "amcl": "/amcl",
    "robot-localization": "/ekf_filter_node",
}


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class GatesTable(_Table):
    """When nothing is learned."""

    stale_after: Seconds = 1.0  # s without input, after which that is said
    reverse: bool | None = None  # learn in reverse; None: unless the start model never drove so


class ApplyTable(_Table):
    """What is handed to other programs, and how fast it may change."""

    mode: ApplyMode = "off"
    folder: str | None = None  # the model and the files of the targets are written here
    targets: list[Literal["diff-drive", "mppi", "amcl", "robot-localization"]] = []
    set_parameters: bool = False  # set the parameters of running ROS nodes, too: those that they take
    ros_distro: Literal["humble", "jazzy", "kilted", "lyrical", "rolling"] | None = None  # None: $ROS_DISTRO
    update_rate: Annotated[float, Field(ge=0.1, le=1e5)] | None = None  # Hz, of the controller manager
    planning_horizon: Annotated[float, Field(ge=0.01, le=1000.0)] = 2.8  # s that MPPI plans ahead
    nodes: dict[str, str] = {}  # target: the node's name, where it is not the usual one
    interval: Seconds = 10.0  # s between two times at least
    threshold: Annotated[float, Field(ge=0.0, le=10.0)] = 0.02  # prior sd that a parameter moved, at least
    within: Annotated[float, Field(gt=0.0, le=10.0)] = 1.0  # prior sd beyond what is certain, at most
    rate: Annotated[float, Field(gt=0.0, le=10.0)] = 0.01  # prior sd a second, at most


class LiveTable(_Table):
    """Where samples come from and where results go; the command line goes before it."""

    name: Annotated[str, Field(min_length=1, max_length=64)] = "robot"  # of the robot
    node: Name = "slipwise"  # name of the ROS node
    transport: Transports | None = None  # None: the first ROS that is there
    domain: Annotated[int, Field(ge=0, le=232)] | None = None  # None: ROS_DOMAIN_ID, else 0
    network: bool = False  # DDS reaches beyond this host
    address: str | None = None  # where UDP is listened for, as host:port
    override_topic: str | None = None  # std_msgs/Bool: an operator drives
    input: Literal["command", "wheel"] | None = None
    positions: bool = False  # poses are positions without a heading; a log, lines and ROS topics say so
    gyro_alone: bool = False  # no poses come, and turns of a gyro are learned from; said as positions are
    sources: list[str] = []  # of poses, where there are several: the first first; fixes need one at least
    vehicle: str | None = None  # a car that is commanded by throttle and steering, as --vehicle says
    model: str | None = None  # start model
    attitude: bool = False  # poses have a true roll and pitch: terms of gravity are tried
    sideways: bool = False  # the robot drives sideways too: terms of its sideways speed are tried
    memory: bool = False  # remember surfaces, and begin with those of the start model
    surface: Annotated[str, Field(min_length=1, max_length=80)] | None = None  # name of the first surface
    surface_topic: str | None = None  # std_msgs/String: the surface's name, beside ~/terrain
    cache: str | None = None  # folder
    save_every: Seconds = 60.0  # s of the wall clock between two times that the cache is written
    moves_every: Annotated[float, Field(ge=0.0, le=1e6)] = 10.0  # s between two looks for moves; 0: none
    host: str = "127.0.0.1"  # where the web page is served
    duration: Seconds | None = None  # s of the wall clock, after which the node stops
    gates: GatesTable = GatesTable()
    apply: ApplyTable = ApplyTable()

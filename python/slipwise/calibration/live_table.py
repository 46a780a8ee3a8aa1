# SPDX-License-Identifier: Apache-2.0
"""The part of the settings that `slipwise live` reads; it changes nothing of how a log is learned."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from slipwise.addresses import host_and_port
from slipwise.calibration.keys import key
from slipwise.models.inputs import InputName, singular

Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Seconds = Annotated[float, Field(gt=0.0, le=1e6)]
Transports = Literal["ros", "rclpy", "cyclonedds", "stdin", "udp"]
ApplyMode = Literal["off", "manual", "auto"]
LOOPBACK = "127.0.0.1"
TARGET_NODES = {  # whose parameters are set where none is named
    "diff-drive": "/diff_drive_controller",
    "mppi": "/controller_server",
    "amcl": "/amcl",
    "robot-localization": "/ekf_filter_node",
}


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ApplyTable(_Table):
    """What is handed to other programs (robot-at-work.md)."""

    mode: ApplyMode = key("off", 'hand the model to other programs: "manual": on a call, "auto": by itself')
    folder: str | None = key(
        None, "model.yaml and the files of the targets are written there", example='"apply"'
    )
    targets: list[Literal["diff-drive", "mppi", "amcl", "robot-localization"]] = key(
        [], "diff-drive, mppi, amcl, robot-localization"
    )
    set_parameters: bool = key(
        False,
        "true: set parameters of running ROS nodes, too: those that they take while they run, never a limit",
    )
    nodes: dict[str, str] = key(
        {}, 'such as { mppi = "/controller_server" }, where a node is not called as usual'
    )
    interval: Seconds = key(10.0, "s between two times at least; more where a restart of a target costs")


class LiveTable(_Table):
    """Where samples come from and where results go."""

    node: Name = key("slipwise", "name of the ROS node; two nodes on one network need two")
    network: bool = key(False, "true: DDS reaches beyond this host")
    address: str | None = key(
        None,
        "where the web page is served and, with a port, UDP is listened for; default 127.0.0.1:7447; 0.0.0.0 "
        "is open to others",
        example='"0.0.0.0:7447"',
    )
    override_topic: str | None = key(
        None, "std_msgs/Bool: an operator drives, and nothing is learned", example='"/manual"'
    )
    surface_topic: str | None = key(
        None, "std_msgs/String: the surface's name, beside ~/terrain", example='"/label"'
    )
    positions: bool = key(
        False,
        "true: ROS poses whose headings are a course over ground are positions; a log and lines show it by "
        "themselves",
    )
    apply: ApplyTable = ApplyTable()
    # Options of the command line:
    name: Annotated[str, Field(min_length=1, max_length=64)] = "robot"  # of the robot
    transport: Transports | None = None  # None: the first ROS that is there
    input: Annotated[InputName | None, BeforeValidator(singular)] = None
    model: str | None = None  # start model
    memory: bool = False  # remember surfaces, and begin with those of the start model
    surface: Annotated[str, Field(min_length=1, max_length=80)] | None = None  # name of the first surface
    cache: str | None = None  # folder
    # What arrives says these (`calibration.coming`):
    gyro_alone: bool = False  # no poses come, and turns of a gyro are learned from
    sources: list[str] = []  # of poses, where there are several: the first first; fixes need one at least
    vehicle: str | None = None  # a car that is commanded by throttle and steering, as --vehicle says
    wheelbase: float | None = None  # m, of a robot that is commanded to steer, as --wheelbase says
    attitude: bool = False  # poses have a true roll and pitch: terms of gravity are tried
    sideways: bool = False  # the robot drives sideways too: terms of its sideways speed are tried
    # Read for one release from files that have them:
    domain: Annotated[int, Field(ge=0, le=232)] | None = None  # None: ROS_DOMAIN_ID, else 0
    duration: Seconds | None = None  # s of the wall clock, after which the node stops

    @property
    def host(self) -> str:
        """Where the web page is served."""
        return host_and_port(self.address or "")[0] or LOOPBACK

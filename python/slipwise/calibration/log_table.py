# SPDX-License-Identifier: Apache-2.0
"""The part of the settings that says how to read a log: what `LogOptions` takes, under the same names."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from slipwise.logs.options import LogOptions
from slipwise.logs.remote import MOST_FETCHED
from slipwise.logs.unpacking import MOST_UNPACKED

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Radians = Annotated[float, Field(allow_inf_nan=False)]
Factors = Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=2, max_length=2)]
Several = Annotated[list[str], Field(min_length=1)]
Seconds = Annotated[float, Field(allow_inf_nan=False)]


class LogTable(BaseModel):
    """How to read the log; what is not given is guessed, and the command line goes before it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    command_topic: str | None = None
    pose_topic: str | Several | None = None  # several: sources beside the first
    wheel_topic: str | None = None
    imu_topic: str | None = None
    pose_frame: str | None = None
    child_frame: str | None = None
    left_joints: list[str] = []
    right_joints: list[str] = []
    wheel_radius: Positive | None = None  # m
    wheel_separation: Positive | None = None  # m
    wheelbase: Positive | None = None  # m
    vehicle: str | None = None  # a preset or a .yaml file
    command_scale: Factors = [1.0, 1.0]  # of the commanded speed and yaw rate
    wheel_scale: Factors = [1.0, 1.0]  # of the wheels'
    pose_yaw_offset: Radians = 0.0  # rad
    most_unpacked: Positive = MOST_UNPACKED  # MiB that a compressed table, or a chunk of a bag, may unpack to
    most_fetched: Positive = MOST_FETCHED  # MiB that a log on a server may have
    poses: str | Several | None = None  # a file beside the log
    pose_clock_offset: Seconds | Literal["auto"] | None = None  # s
    command_timeout: Positive | None = None  # s
    start: Seconds | None = None  # s
    end: Seconds | None = None  # s
    columns: dict[str, str] = {}  # tidy name: name in the table

    def options(self, unknown_after: float, given: dict[str, Any]) -> LogOptions:
        """Return the options for `open_log`; what is `given` goes before what stands here."""
        own: dict[str, Any] = self.model_dump(exclude_defaults=True)
        for name in ("left_joints", "right_joints", "command_scale", "wheel_scale"):
            if name in own:
                own[name] = tuple(own[name])
        for name, further in (("poses", "other_poses"), ("pose_topic", "other_pose_topics")):
            if isinstance(own.get(name), list):
                own[name], *others = own[name]
                own |= {further: tuple(others)} if name not in given else {}
        if "poses" in own:
            own["poses"] = Path(own["poses"])
        if "other_poses" in own:
            own["other_poses"] = tuple(map(Path, own["other_poses"]))
        if "columns" in given:
            given = given | {"columns": own.get("columns", {}) | given["columns"]}
        return LogOptions(**({"unknown_after": unknown_after} | own | given))

# SPDX-License-Identifier: Apache-2.0
"""What settings say of several sources of poses: where each sits, and how late its stamps are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from slipwise import _core
from slipwise.errors import SettingsError

_DEFAULT = _core.SourceSettings()
_FARTHEST = 50.0  # m from base_link; more is a wrong unit
_LATEST = 60.0  # s
_SENSOR_STD = (0.3, 0.2)  # m and rad, where a guess is learned about
Metres = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST)]
Seconds = Annotated[float, Field(ge=-_LATEST, le=_LATEST)]


class PoseSourceTable(BaseModel):
    """A source of poses beside the first, of which [sensor_extrinsics] and [prior] speak."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str  # as the log has it: in the column `source`, or the topic, or the stem of the file
    x: Metres = 0.0  # m, where it sits in base_link
    y: Metres = 0.0  # m
    yaw: Annotated[float, Field(ge=-math.pi, le=math.pi)] = 0.0  # rad
    learn_extrinsics: bool | None = None  # the pose above is a guess; None: where none is given
    late: Seconds = 0.0  # s by which its stamps are known to be late
    learn_clock_offset: bool = True  # what adds to that
    poorest: Annotated[float, Field(ge=1.0, le=1e6)] = _DEFAULT.poorest  # times the best source's errors

    @property
    def learns_place(self) -> bool:
        """Whether the place is learned: where it is a guess, or nobody said where the source sits."""
        if self.learn_extrinsics is not None:
            return self.learn_extrinsics
        return not self.model_fields_set & {"x", "y", "yaw"}

    def core(self, clock_std: float) -> _core.SourceSettings:
        """Return what the core takes; `clock_std` [s] is of a lateness that is learned."""
        source = _core.SourceSettings()
        source.sensor, source.late, source.poorest = (
            _core.Pose2(self.x, self.y, self.yaw),
            self.late,
            self.poorest,
        )
        source.clock_std = clock_std if self.learn_clock_offset else 0.0
        source.sensor_std_xy, source.sensor_std_yaw = _SENSOR_STD if self.learns_place else (0.0, 0.0)
        return source


def core_sources(
    names: Sequence[str], tables: Sequence[PoseSourceTable], clock_std: float
) -> list[_core.SourceSettings]:
    """Return the settings of each source by name; the first is the model's own.

    Raises:
        SettingsError: settings name a source that is not there, or the first one.
    """
    said = {table.name: table for table in tables}
    for name in said:
        if names and name not in names[1:]:
            which = "the first source" if name == names[0] else "not there"
            raise SettingsError(
                f"[[pose_sources]] names '{name}', which is {which}",
                advice=f"sources beside the first are {', '.join(names[1:]) or 'none'}; of the first speak "
                "[sensor_extrinsics] and learn_clock_offset",
            )
    return [said.get(name, PoseSourceTable(name=name)).core(clock_std) for name in names]

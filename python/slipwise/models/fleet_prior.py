# SPDX-License-Identifier: Apache-2.0
"""What a fleet knows of a robot of a type before its first log: the file that `slipwise fleet` writes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from slipwise.errors import ModelError
from slipwise.models.inputs import InputName
from slipwise.models.schema import Finite, NotNegative, Positive
from slipwise.models.yaml_file import read_yaml
from slipwise.validation_text import first_problem

PRIOR_SCHEMA = 2
_ADVICE = "write it again with `slipwise fleet`"
Row = list[Finite]
Scale = Annotated[list[Positive], Field(min_length=3, max_length=3)]
Speeds = Annotated[list[Positive], Field(min_length=2, max_length=2)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Normal(_Section):
    """A normal distribution of parameters."""

    mean: Row
    covariance: list[Row]

    @model_validator(mode="after")
    def _square(self) -> _Normal:
        if len(self.covariance) != len(self.mean) or any(len(r) != len(self.mean) for r in self.covariance):
            raise ValueError("the covariance needs a row and a column for each number of the mean")
        return self


class BasisPrior(_Normal):
    """Slip of the next robot in the terms of one basis."""

    weight: NotNegative  # of the basis, of all together 1
    variance_scale: Scale  # learned factor of the variances of (x, y, yaw) [-]


class RobotPrior(_Normal):
    """Lags, delays, gains and offsets of the next robot."""

    parameters: list[str]

    @model_validator(mode="after")
    def _named(self) -> RobotPrior:
        if len(self.parameters) != len(self.mean):
            raise ValueError("each number of the mean needs a name")
        return self


class ParameterPrior(_Section):
    """One parameter by itself, for people; learning begins with the joint distributions."""

    unit: str
    mean: Finite
    std: NotNegative  # of a new robot
    between_robots_std: NotNegative
    robots: int


class StartPrior(_Section):
    """What learning begins with."""

    input: InputName
    structure: Literal["joint", "cascaded", "direct"]  # how motion was explained best
    speeds: Speeds  # of the priors that slip was learned under [m/s, rad/s]
    bases: Annotated[dict[str, BasisPrior], Field(min_length=1)]
    robot: RobotPrior


class FleetPriorFile(_Section):
    """The whole file."""

    slipwise_fleet_prior: Literal[2]
    type: str  # of vehicle, as it was named
    robots: Annotated[int, Field(ge=0)]
    logs: Annotated[int, Field(ge=0)]
    parameters: dict[str, ParameterPrior]
    start: StartPrior | None = None  # None where fewer than two robots could be used


def load_prior(path: Path) -> FleetPriorFile:
    """Return the prior in a file.

    Raises:
        ModelError: it is missing, not plain YAML, or no such prior.
    """
    content = read_yaml(path)
    if content.get("slipwise_fleet_prior") == 1:
        raise ModelError("a fleet prior of an older slipwise", where=str(path), advice=_ADVICE)
    try:
        return FleetPriorFile.model_validate(content)
    except ValidationError as problem:
        raise ModelError(
            f"not a fleet's prior: {first_problem(problem)}", where=str(path), advice=_ADVICE
        ) from None

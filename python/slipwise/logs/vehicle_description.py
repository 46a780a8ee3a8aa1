# SPDX-License-Identifier: Apache-2.0
"""What a vehicle drives on: wheels, tracks or axles, described in YAML or by the name of a preset."""

from __future__ import annotations

import functools
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.yaml_file import parse_yaml, read_yaml
from slipwise.validation_text import first_problem


def _not_0(factor: float) -> float:
    if factor == 0.0:
        raise ValueError("a factor is not 0")
    return factor


Metres = Annotated[float, Field(ge=-50.0, le=50.0)]
Size = Annotated[float, Field(gt=0.0, le=50.0)]  # m
Angle = Annotated[float, Field(ge=-6.3, le=6.3)]  # rad
Std = Annotated[float, Field(gt=0.0, le=10.0)]  # m/s
Factor = Annotated[float, Field(ge=-1e6, le=1e6), AfterValidator(_not_0)]
Name = Annotated[str, Field(min_length=1, max_length=200)]

_SECTION = "vehicle"
_SEE = "docs/vehicles.md has every key"
_MOST_WHEELS = 64


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class WheelDescription(_Part):
    """One wheel; its speed is the column `wheel_NAME` of a table, or the joint NAME or `wheel_NAME`."""

    name: Name
    x: Metres  # ahead of base_link
    y: Metres  # to the left of it
    radius: Size
    angle: Angle = 0.0  # it rolls in while its steering reads 0
    steer: Name | None = None  # its steering angle: the column or joint `steer_STEER`, or the joint STEER
    roller: Annotated[float, Field(ge=-1.4, le=1.4)] | None = None  # axes of rollers, to its direction
    slides: bool = False  # across its direction, as the wheels of skid steering do
    driven: bool = True  # its speed is read; false where only its steering is
    behind_hinge: bool = False
    pivot: tuple[Metres, Metres] | None = None  # x, y of the joint that steers it; none: above its contact
    reversed: bool = False  # its speed counts backwards, as the joints of a mirrored side do
    steer_reversed: bool = False  # its steering angle counts to the right

    def core(self) -> _core.Wheel:
        """Return the wheel as the core knows it."""
        return _core.Wheel(
            x=self.x,
            y=self.y,
            radius=self.radius,
            angle=self.angle,
            roller=0.0 if self.slides else self.roller,
            steered=self.steer is not None,
            behind_hinge=self.behind_hinge,
            pivot=self.pivot,
        )


class Tracks(_Part):
    """Two tracks, or the wheels of two sides: skid steering and differential drives."""

    radius: Size  # m, of the sprocket or wheel
    separation: Size  # m, between the middles of left and right


class ThrottleSteering(_Part):
    """A car commanded by throttle and steering in [-1, 1]: what is taken before its curves are learned."""

    top_speed: Annotated[float, Field(gt=0.0, le=100.0)]  # m/s, at full throttle
    curvature: Annotated[float, Field(gt=0.0, le=100.0)]  # 1/m, at full steering


class HingeDescription(_Part):
    """The joint of an articulated vehicle; its angle is the column `steer_NAME` or the joint NAME."""

    name: Name
    x: Metres
    y: Metres = 0.0


class VehicleDescription(_Part):
    """A vehicle; one of wheels, tracks or a wheelbase says what it drives on."""

    source: str = ""  # where the numbers come from
    tracks: Tracks | None = None
    left_joints: list[Name] = []  # of tracks
    right_joints: list[Name] = []
    wheelbase: Size | None = None  # m, of a car that is commanded or measured by its steering angle
    throttle_steering: ThrottleSteering | None = None  # of a wheelbase, where commands have no units
    wheel_scale: tuple[Factor, Factor] = (1.0, 1.0)  # of the speed and the yaw rate that its wheels tell
    wheels: list[WheelDescription] = Field([], max_length=_MOST_WHEELS)
    hinge: HingeDescription | None = None
    rolling_std: Std = 0.02  # m/s, along the rollers' axes or a plain wheel's direction
    sideways_std: Std = 0.02  # m/s, across a plain wheel

    @property
    def names(self) -> frozenset[str]:
        """The names of wheels and joints, of which columns and joints have theirs."""
        named = [name for wheel in self.wheels for name in (wheel.name, wheel.steer)]
        hinge = None if self.hinge is None else self.hinge.name
        return frozenset(name for name in (*named, hinge) if name is not None)

    @functools.cached_property
    def layout(self) -> _core.WheelLayout | None:
        """The wheels, or None where there are none; made once, since every message of a live robot asks.

        Raises:
            SettingsError: the wheels do not tell a motion.
        """
        if not self.wheels:
            return None
        hinge = None if self.hinge is None else (self.hinge.x, self.hinge.y)
        try:
            return _core.WheelLayout(
                [wheel.core() for wheel in self.wheels],
                rolling=self.rolling_std,
                sideways=self.sideways_std,
                hinge=hinge,
            )
        except ValueError as wrong:
            raise SettingsError(str(wrong), where="wheels", advice=_SEE) from wrong


def vehicle_names() -> tuple[str, ...]:
    """Return the names of the presets."""
    return tuple(_presets())


@functools.lru_cache(maxsize=8)
def load_vehicle(name_or_file: str) -> VehicleDescription:
    """Return a preset by its name, or what stands in the section `vehicle` of a YAML file.

    Raises:
        SettingsError: neither is there, or what stands there makes no sense.
    """
    if name_or_file in _presets():
        return _checked(_presets()[name_or_file], where=name_or_file)
    path = Path(name_or_file)
    if path.suffix not in (".yaml", ".yml"):
        raise SettingsError(
            f"unknown vehicle {name_or_file!r}",
            where="--vehicle",
            advice=f"known are {', '.join(_presets())}; or give a .yaml file with a section vehicle",
        )
    content = read_yaml(path, error=SettingsError)
    if _SECTION not in content:
        raise SettingsError(f"there is no section {_SECTION}", where=str(path), advice=_SEE)
    return _checked(content[_SECTION], where=str(path))


def _checked(content: Any, *, where: str) -> VehicleDescription:
    try:
        found = VehicleDescription.model_validate(content)
    except ValidationError as error:
        raise SettingsError(first_problem(error), where=where, advice=_SEE) from error
    given = [name for name in ("tracks", "wheelbase", "wheels") if getattr(found, name)]
    if len(given) != 1:
        said = " and ".join(given) if given else "none of them"
        advice = f"give one of tracks, wheelbase and wheels; {_SEE}"
        raise SettingsError(
            f"a vehicle drives on one kind of thing, not on {said}", where=where, advice=advice
        )
    if found.throttle_steering is not None and found.wheelbase is None:
        advice = f"give the wheelbase of the car; {_SEE}"
        raise SettingsError("throttle_steering is of a car", where=where, advice=advice)
    names = [wheel.name for wheel in found.wheels]
    if len(set(names)) < len(names):
        raise SettingsError("two wheels have the same name", where=where, advice="name them by their joints")
    _ = found.layout  # refused here, not when the first wheel is read
    return found


@functools.cache
def _presets() -> dict[str, Any]:
    text = resources.files("slipwise.logs").joinpath("vehicle_presets.yaml").read_bytes()
    return parse_yaml(text, where="vehicle_presets.yaml", error=SettingsError)

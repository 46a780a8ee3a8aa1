# SPDX-License-Identifier: Apache-2.0
"""The tools that a model can be exported for, and the text of their files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from slipwise.argument_types import check_arguments
from slipwise.errors import ModelError, SettingsError
from slipwise.export.amcl import amcl
from slipwise.export.autoware import autoware
from slipwise.export.c_header import c_header
from slipwise.export.diff_drive import diff_drive
from slipwise.export.firmware import FirmwareFile, ardupilot, px4
from slipwise.export.mounts import mount_of_look, mounts_text
from slipwise.export.mppi import mppi
from slipwise.export.options import LOGGED, ExportOptions
from slipwise.export.origin import origin_lines
from slipwise.export.parameter_file import ParameterFile, Value
from slipwise.export.robot_localization import robot_localization
from slipwise.models.axes import refuse_sideways
from slipwise.models.body_force import without_force
from slipwise.models.inputs import InputName
from slipwise.models.model import Model
from slipwise.models.mounted import UNITS, first_mount, mounts_in


@dataclass(frozen=True)
class Exported:
    """The text of one file, the values in it by their names, and why others are not written."""

    text: str
    values: dict[str, Value]
    kept: dict[str, str] = field(default_factory=dict)
    parameters: ParameterFile | None = None  # of a ROS node


@dataclass(frozen=True)
class Target:
    """A tool, the usual name of its file, and how the file is made."""

    name: str
    file_name: str
    make: Callable[[Model, ExportOptions, list[str]], Exported]
    sideways: bool = False  # whether the file can hold a sideways speed
    steers: bool = True  # whether a robot that steers has such a file
    input: InputName | None = None  # that its numbers are of; None: of either
    reads: frozenset[str] = frozenset()  # the options that its file depends on

    def refuse_others(self, options: ExportOptions) -> None:
        """Refuse options that say nothing about this file, which whoever gave them expects to find in it.

        Raises:
            SettingsError: there is one.
        """
        for name in options.given():
            if name not in self.reads:
                option = f"--{name.replace('_', '-')}"
                readers = ", ".join(each.name for each in (*TARGETS, MOUNTS) if name in each.reads)
                raise SettingsError(
                    f"{self.name} takes no {option}",
                    where=option,
                    advice=f"it is for {readers}; leave it out",
                )
        theirs = LOGGED.get(self.name, ())
        for name in options.logged:
            if name not in theirs:
                what = f"{self.name} has no {name}"
                raise SettingsError(what, where="--logged", advice=f"its own are {', '.join(theirs)}")


def _parameters(make: Callable[[Model, ExportOptions], ParameterFile]) -> Callable[..., Exported]:
    def write(model: Model, options: ExportOptions, origin: list[str]) -> Exported:
        file = make(model.body, options)
        return Exported(file.text(origin), file.values(), file.kept(), file)

    return write


def _firmware(make: Callable[[Model, ExportOptions, list[str]], FirmwareFile]) -> Callable[..., Exported]:
    def write(model: Model, options: ExportOptions, origin: list[str]) -> Exported:
        file = make(model.body, options, origin)
        return Exported(file.text, file.values, file.kept)

    return write


def _c_header(model: Model, _: ExportOptions, origin: list[str]) -> Exported:
    return Exported(c_header(model, origin), {p.name: p.value for p in model.content.parameters})


def _mounts(model: Model, options: ExportOptions, origin: list[str]) -> Exported:
    first = first_mount(model)
    if options.no_side_slip or not ((first and first.sentence()) or mounts_in(model)):
        first = mount_of_look(model)
        if not options.no_side_slip:
            raise ModelError(
                f"one source of poses does not tell side slip from a mount ({first.sentence()})",
                advice="add --no-side-slip where the robot does not slip sideways",
            )
    found = (*((first,) if first and first.sentence() else ()), *mounts_in(model, first))
    values = {
        number if mount.first else f"{mount.name} {number}": estimate[0]
        for mount in found
        for number in UNITS
        if (estimate := getattr(mount, number)) is not None
    }
    return Exported(mounts_text(found, origin), values)


_WHEELS = {"wheel_separation", "logged_separation_multiplier", "input_scale"}
_FIRMWARE = frozenset({*_WHEELS, "limits", "logged", "min_turning_radius", "wheel_base"})
_DIFF_DRIVE = frozenset(
    {*_WHEELS, "logged_radius_multiplier", "horizon", "limits", "min_turning_radius", "update_rate"}
)
_MPPI = frozenset({"limits", "min_turning_radius", "planning_horizon", "input_scale"})

TARGETS = (
    Target(
        "diff-drive",
        "diff_drive_controller.yaml",
        _parameters(diff_drive),
        steers=False,
        input="wheel",
        reads=_DIFF_DRIVE,
    ),
    Target("mppi", "nav2_mppi.yaml", _parameters(mppi), input="command", reads=_MPPI),
    Target(
        "amcl",
        "nav2_amcl.yaml",
        _parameters(amcl),
        input="wheel",
        reads=frozenset({"horizon", "omni", "small_alphas", "input_scale"}),
    ),
    Target(
        "robot-localization",
        "robot_localization.yaml",
        _parameters(robot_localization),
        reads=frozenset({"horizon", "stamped_commands", "filter_rate", "input_scale"}),
    ),
    Target(
        "autoware",
        "autoware.param.yaml",
        _parameters(autoware),
        input="wheel",
        reads=frozenset({"wheel_base", "logged", "input_scale"}),
    ),
    Target("px4", "px4.params", _firmware(px4), reads=_FIRMWARE | {"px4"}),
    Target("ardupilot", "ardupilot.param", _firmware(ardupilot), reads=_FIRMWARE | {"ardupilot"}),
    Target("c-header", "model.h", _c_header, sideways=True, reads=frozenset({"input_scale"})),
)
#: Of models with several sources of poses, or whose slip is said to be one.
MOUNTS = Target("mounts", "sensor_mounts.txt", _mounts, sideways=True, reads=frozenset({"no_side_slip"}))


def find_target(name: str) -> Target:
    """Return a target by its name.

    Raises:
        SettingsError: there is none.
    """
    for target in (*TARGETS, MOUNTS):
        if target.name == name:
            return target
    raise SettingsError(
        f"unknown target '{name}'", advice=f"one of {', '.join(t.name for t in (*TARGETS, MOUNTS))}"
    )


def export_model(
    model: Model, target: str, *, name: str, options: ExportOptions | None = None, force: bool = False
) -> Exported:
    """Return the file of one target.

    Args:
        model: a learned model.
        target: whose file, such as `diff-drive`.
        name: of the model file, for the comment on top.
        options: what the model does not hold.
        force: export a model whose verdict is bad, too.

    Raises:
        ModelError: the verdict is bad, or the model does not fit the target.
        SettingsError: there is no such target.
    """
    check_arguments(export_model, locals())
    made = find_target(target)
    part = without_force(for_target(model, made))
    part.refuse_throttle("exported files")
    if model.steers and not made.steers:  # as either input says, whichever the file is of
        what = made.file_name.removesuffix(".yaml")
        raise ModelError(f"a robot that steers has no {what}", advice="export another file")
    if not made.sideways:
        refuse_sideways(part, f"files of {target}")
    if not force:
        refuse_bad_verdict(part)
    return made.make(part, _unscaled(part, made, options or ExportOptions()), origin_lines(part, name))


def _unscaled(model: Model, target: Target, options: ExportOptions) -> ExportOptions:
    """Return options by which numbers are for what the robot itself says, where a log was read with a scale.

    Raises:
        ModelError: nobody says whether the robot itself is wrong by it, or the file cannot hold that.
    """
    scale = model.content.provenance.input_scale
    if scale is None or "input_scale" not in target.reads or options.input_scale == "log":
        return options
    speed, yaw_rate = scale
    if options.input_scale == "robot" and "logged_radius_multiplier" in target.reads:
        return replace(
            options,
            logged_radius_multiplier=options.logged_radius_multiplier * speed,
            logged_separation_multiplier=options.logged_separation_multiplier * speed / yaw_rate,
        )
    inputs = {"command": "commands", "wheel": "wheel speeds"}[model.content.input]
    raise ModelError(
        f"the {inputs} of the log were multiplied by {speed:g} and {yaw_rate:g}, and {target.name} takes the "
        "robot's own",
        advice="--input-scale log where the robot's own are right, and the log has another unit; else mend "
        "the robot and record again, or let diff-drive mend it by --input-scale robot",
    )


def for_target(model: Model, target: Target) -> Model:
    """Return the model from the input that a target takes; as it is where the target takes either."""
    return model.of_input(target.input) if target.input in model.inputs else model


def refuse_bad_verdict(model: Model) -> None:
    """Raise for a model that is not good enough.

    Raises:
        ModelError: the verdict is bad.
    """
    verdict = model.content.verdict
    if not verdict.good:
        raise ModelError(
            f"the model's verdict is bad: {verdict.sentence}",
            advice="learn from a better log, or use --force to export it all the same",
        )

# SPDX-License-Identifier: Apache-2.0
"""Each file of each release of ROS holds what that release declares, and no limit that nobody asked for."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_models import LIMITS, Made, make_model, named

from slipwise.export import ExportOptions, export_model
from slipwise.export.parameter_file import Value
from slipwise.export.ros_tables import DISTROS, TABLES, RosTable, motion_model

WHEEL = named("edd-2", lon__V=-0.05, ang__w=-0.4)
COMMAND = replace(WHEEL, commands=True, limits=LIMITS)
OF_TARGET = {"diff-drive": WHEEL, "mppi": COMMAND, "amcl": WHEEL, "robot-localization": COMMAND}
ALL = ExportOptions(
    limits=True, wheel_separation=0.5, update_rate=100.0, stamped_commands=True, small_alphas=True, omni=True
)


def kind_of(value: Value) -> str:
    if isinstance(value, list):
        return "bool_array" if isinstance(value[0], bool) else "double_array"
    return {bool: "bool", float: "double", str: "string"}[type(value)]


def wrong(made: Made, table: RosTable, options: ExportOptions) -> list[str]:
    """What a file holds that the release does not declare, or that must not be in it."""
    declared = table.of_distro(options.ros_distro)
    values = export_model(make_model(made), table.target, name="m", options=options).values
    where = f"{table.target} {options.ros_distro}"
    found = [f"{where}: {name} is not declared" for name in values if name not in declared]
    found += [
        f"{where}: {name} is {kind_of(value)}"
        for name, value in values.items()
        if name in declared and kind_of(value) != declared[name].kind
    ]
    if not options.limits:
        found += [
            f"{where}: {name} is a limit" for name in values if name in declared and declared[name].limit
        ]
    return [*found, *([] if values else [f"{where}: nothing is written"])]


@pytest.mark.parametrize("target", TABLES)
def test_a_file_of_a_release_holds_what_it_declares_and_limits_on_request_alone(target: str) -> None:
    options = [
        replace(ALL, ros_distro=distro, limits=limits) for distro in DISTROS for limits in (True, False)
    ]
    if target == "mppi":
        options += [replace(each, min_turning_radius=0.8) for each in options]
    assert [text for each in options for text in wrong(OF_TARGET[target], TABLES[target], each)] == []


def test_motion_models_are_those_that_the_release_configures_with() -> None:
    for distro in ("humble", "jazzy", "kilted"):
        assert {motion_model(kind, distro)[0] for kind in ("diff-drive", "ackermann")} <= {
            "DiffDrive",
            "Omni",
            "Ackermann",
        }
    for distro in ("lyrical", "rolling"):
        assert motion_model("diff-drive", distro) == ("diff_drive", "mppi::DiffDriveMotionModel")


def test_read_only_parameters_of_the_controller_want_a_restart_in_every_release() -> None:
    for distro in DISTROS:
        table = TABLES["diff-drive"].of_distro(distro)
        fixed = [name for name, each in table.items() if "multiplier" in name or "covariance" in name]
        assert len(fixed) == 5
        assert all(table[name].effect == "at a restart" for name in fixed)
    assert TABLES["diff-drive"].of_distro("lyrical")["linear.x.max_velocity"].effect == "at once"

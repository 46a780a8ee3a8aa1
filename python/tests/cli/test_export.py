# SPDX-License-Identifier: Apache-2.0
"""`slipwise export` writes files whole or not at all, says what it left out, and refuses in one line."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from cli.conftest import Result, left_in
from sample_models import make_model, named

from slipwise.models import Model

Slipwise = Callable[..., Result]

WHEEL = named("edd-2", lon__V=-0.1, ang__w=-0.3)
ALL_OF_WHEEL = {
    "diff_drive_controller.yaml",
    "nav2_amcl.yaml",
    "robot_localization.yaml",
    "autoware.param.yaml",
    "model.h",
}


@pytest.fixture
def wheel(folder: Path) -> Path:
    return make_model(WHEEL).save(folder / "wheel.yaml")


@pytest.fixture
def command(folder: Path) -> Path:
    return make_model(replace(WHEEL, commands=True)).save(folder / "command.yaml")


@pytest.fixture
def bad(folder: Path) -> Path:
    made = replace(WHEEL, good=False, sentence="It does not beat doing nothing.")
    return make_model(made).save(folder / "bad.yaml")


def test_one_target_is_written_to_the_file_that_is_named(slipwise: Slipwise, wheel: Path) -> None:
    result = slipwise("export", wheel, "--to", "diff-drive", "--ros-distro", "jazzy", "-o", "robot/dd.yaml")
    assert (result.code, result.err) == (0, "")
    parameters = yaml.safe_load(Path("robot/dd.yaml").read_text())["diff_drive_controller"]["ros__parameters"]
    assert parameters["wheel_separation_multiplier"] == pytest.approx(0.9 / 0.7, rel=1e-5)
    assert "wheel_separation_multiplier" in result.out
    assert "1.286" in result.out
    assert "robot/dd.yaml" in result.out


def test_a_version_of_a_firmware_chooses_its_file(slipwise: Slipwise, command: Path) -> None:
    assert slipwise("export", command, "--px4", "1.17", "--logged", "RO_MAX_THR_SPEED=2").code == 0
    assert "RO_MAX_THR_SPEED\t1.8" in Path("px4.params").read_text()
    assert slipwise("export", command, "--ardupilot", "4.6").code == 0
    assert "Limits are left as they are" in Path("ardupilot.param").read_text()


def test_without_an_output_the_file_has_its_usual_name(slipwise: Slipwise, wheel: Path) -> None:
    assert slipwise("export", wheel, "--to", "c-header").code == 0
    assert left_in(Path()) == {"wheel.yaml", "model.h"}


def test_all_writes_what_fits_and_says_what_does_not(slipwise: Slipwise, wheel: Path) -> None:
    result = slipwise("export", wheel, "--to", "all", "-o", "config", "--ros-distro", "jazzy")
    assert result.code == 0
    assert left_in(Path("config")) == ALL_OF_WHEEL
    assert "mppi skipped: " in result.out
    assert "--input command" in result.out


def test_the_release_of_ros_is_asked_for_where_it_matters(
    slipwise: Slipwise, command: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    result = slipwise("export", command, "--to", "mppi")
    assert result.code == 2
    assert "differ between ROS releases" in result.err
    assert "--ros-distro" in result.err
    monkeypatch.setenv("ROS_DISTRO", "kilted")
    assert slipwise("export", command, "--to", "mppi").code == 0
    assert 'motion_model: "DiffDrive"' in Path("nav2_mppi.yaml").read_text()


def test_json_holds_files_parameters_and_what_was_left_out(slipwise: Slipwise, command: Path) -> None:
    asked = ("--to", "all", "-o", "config", "--ros-distro", "rolling", "--json", "-")
    document = slipwise("export", command, *asked).json
    assert (document["command"], document["exit_code"]) == ("export", 0)
    assert set(document["files"]) == {"mppi", "robot-localization", "c-header"}
    assert set(document["left_out"]) == {"diff-drive", "amcl", "autoware", "px4", "ardupilot"}
    assert document["parameters"]["mppi"]["FollowPath.model_delay_vx"] == pytest.approx(0.5)
    assert all(Path(path).is_file() for path in document["files"].values())


def test_a_bad_verdict_is_refused_with_exit_code_1_and_nothing_is_written(
    slipwise: Slipwise, bad: Path
) -> None:
    result = slipwise("export", bad, "--to", "all", "-o", "config", "--json", "result.json")
    assert (result.code, result.err) == (1, "")
    assert "NOT GOOD ENOUGH. It does not beat doing nothing." in result.out
    assert "--force" in result.out
    assert left_in(Path()) == {"bad.yaml", "result.json"}
    assert json.loads(Path("result.json").read_text())["exit_code"] == 1


def test_a_bad_verdict_is_exported_with_force(slipwise: Slipwise, bad: Path) -> None:
    assert slipwise("export", bad, "--to", "amcl", "--force").code == 0
    assert "NOT GOOD ENOUGH" in Path("nav2_amcl.yaml").read_text()


REFUSED = {
    "commands for wheels": (("command.yaml", "--to", "diff-drive"), "need a model learned from wheel speeds"),
    "wheels for commands": (("wheel.yaml", "--to", "mppi"), "not learned from commands"),
    "Ackermann for wheels": (
        ("wheel.yaml", "--to", "diff-drive", "--ros-distro", "jazzy", "--min-turning-radius", "1"),
        "smallest turning radius has no diff_drive_controller",
    ),
    "other input": (
        ("wheel.yaml", "--to", "diff-drive", "--input", "command"),
        "is of wheel speeds (--input)",
    ),
    "no target": (("wheel.yaml",), "Missing option '--to'"),
    "two firmwares": (("command.yaml", "--px4", "1.17", "--ardupilot", "4.6"), "Missing option '--to'"),
    "no firmware": (("command.yaml", "--to", "px4"), "other names in each version: add --px4"),
    "unknown firmware": (
        ("command.yaml", "--px4", "1.2"),
        "no table of parameters for PX4 1.2 (--px4): one of",
    ),
    "no value": (("command.yaml", "--px4", "1.17", "--logged", "RO_YAW_RATE_CORR"), "give NAME=VALUE"),
    "unknown target": (("wheel.yaml", "--to", "spot"), "'spot' is not one of"),
    "no model": (("none.yaml", "--to", "all"), "cannot read"),
    "other schema": (("other.yaml", "--to", "all"), "schema version 99, this slipwise reads"),
    "not a model": (("text.yaml", "--to", "all"), "the file holds no keys"),
    "no horizon": (
        ("wheel.yaml", "--to", "amcl", "--horizon", "0"),
        "horizon is 0 (--horizon): give 0.01 to 1000 s",
    ),
    "endless horizon": (
        ("wheel.yaml", "--to", "all", "-o", "config", "--horizon", "1e300"),
        "horizon is 1e+300 (--horizon): give 0.01 to 1000 s",
    ),
    "endless separation": (
        ("wheel.yaml", "--to", "diff-drive", "--wheel-separation", "inf"),
        "wheel separation is inf (--wheel-separation): give 0.001 to 100 m",
    ),
    "into a file's folder": (("wheel.yaml", "--to", "all", "-o", "wheel.yaml/x"), "cannot write"),
    "onto a folder": (("wheel.yaml", "--to", "all", "-o", "wheel.yaml"), "cannot write"),
}


def test_bad_use_is_one_line_with_exit_code_2_and_leaves_nothing(
    slipwise: Slipwise, wheel: Path, command: Path, subtests: pytest.Subtests
) -> None:
    for arguments, message in REFUSED.values():
        with subtests.test(arguments=arguments, message=message):
            Path("other.yaml").write_text(
                wheel.read_text().replace("slipwise_model: 5", "slipwise_model: 99")
            )
            Path("text.yaml").write_text("just words\n")
            before = left_in(Path())
            result = slipwise("export", *arguments)
            assert result.code == 2
            assert message in result.line
            assert left_in(Path()) == before


def test_files_that_are_there_are_replaced_whole(slipwise: Slipwise, wheel: Path) -> None:
    Path("model.h").write_text("old\n" * 10_000)
    assert slipwise("export", wheel, "--to", "c-header").code == 0
    text = Path("model.h").read_text()
    assert "old\n" not in text
    assert text.endswith("#endif /* SLIPWISE_MODEL_H */\n")


def test_a_file_of_nav2_is_shown_and_written(slipwise: Slipwise, folder: Path) -> None:
    model = make_model(replace(WHEEL, commands=True)).save(folder / "command.yaml")
    users = folder / "nav2.yaml"
    users.write_text(
        "controller_server:\n  ros__parameters:\n    Follow:  # ours\n"
        '      plugin: "nav2_mppi_controller::MPPIController"\n      model_delay_vx: 0.1 # guessed\n'
    )
    before = users.read_text()
    options = ("export", model, "--merge", users, "--ros-distro", "lyrical")
    result = slipwise(*options)
    assert (result.code, result.err, users.read_text()) == (0, "", before)
    assert "Nothing was written: name the file with -o." in result.out
    assert "robot-localization skipped: no node in it could be ekf_filter_node" in result.out
    document = json.loads(slipwise(*options, "-o", users, "--json", "-").out)
    changes = {each["parameter"]: (each["old"], each["new"]) for each in document["changes"]}
    assert changes["Follow.model_delay_vx"] == ("0.1", "0.5")
    assert users.read_text().startswith(before.replace("0.1 # guessed", "0.5 # guessed"))
    assert (
        yaml.safe_load(users.read_text())["controller_server"]["ros__parameters"]["Follow"]["model_delay_wz"]
        == 0.5
    )
    assert slipwise("export", model, "--to", "c-header", "--merge", users).code == 2
    assert left_in(folder) == {"command.yaml", "nav2.yaml"}


def both(*, good_commands: bool, good_wheels: bool) -> Model:
    """Return a model of commands that answers from wheel speeds too."""
    commands, wheels = (
        make_model(replace(WHEEL, commands=from_commands, good=good)).content
        for from_commands, good in ((True, good_commands), (False, good_wheels))
    )
    return Model(commands.model_copy(update={"other_input": wheels}))


def test_a_model_of_both_inputs_gives_all_files_each_from_the_input_that_it_needs(
    slipwise: Slipwise, folder: Path
) -> None:
    path = both(good_commands=True, good_wheels=True).save(folder / "both.yaml")
    result = slipwise("export", path, "--to", "all", "--ros-distro", "jazzy", "-o", "config")
    assert result.code == 0
    assert {file.name for file in Path("config").iterdir()} == {*ALL_OF_WHEEL, "nav2_mppi.yaml"}
    assert "For commands: robot-localization, c-header; --input wheel writes these for wheel speeds." in (
        " ".join(result.out.split())
    )
    assert slipwise("export", path, "--to", "mppi", "--input", "wheels", "--ros-distro", "jazzy").code == 2


def test_the_input_that_is_not_good_enough_is_left_out(slipwise: Slipwise, folder: Path) -> None:
    path = both(good_commands=False, good_wheels=True).save(folder / "both.yaml")
    result = slipwise("export", path, "--to", "all", "--ros-distro", "jazzy", "-o", "config")
    assert result.code == 0
    assert "What was learned from commands is left out, since it is not good enough" in result.out
    assert {file.name for file in Path("config").iterdir()} == ALL_OF_WHEEL
    assert slipwise("export", path, "--to", "mppi", "--ros-distro", "jazzy").code == 1
    assert slipwise("export", path, "--to", "diff-drive", "--ros-distro", "jazzy").code == 0
    path = both(good_commands=False, good_wheels=False).save(folder / "both.yaml")
    assert slipwise("export", path, "--to", "all", "--ros-distro", "jazzy").code == 1


def test_show_says_both_inputs_or_either(slipwise: Slipwise, folder: Path) -> None:
    path = both(good_commands=True, good_wheels=True).save(folder / "both.yaml")
    shown, wheels = slipwise("show", path), slipwise("show", path, "--input", "wheels")
    assert "learned from commands" in shown.out
    assert "The same file answers from wheel speeds too" in shown.out
    assert "learned from wheels" in wheels.out
    assert "The same file" not in wheels.out


def test_options_of_other_tools_are_refused_with_those_that_take_them(
    slipwise: Slipwise, wheel: Path
) -> None:
    for target in ("c-header", "robot-localization"):
        result = slipwise("export", wheel, "--to", target, "--limits", "-o", "out")
        assert result.code == 2
        assert (
            f"{target} takes no --limits (--limits): it is for diff-drive, mppi, px4, ardupilot" in result.err
        )
        assert not Path("out").exists()
    assert (
        slipwise("export", wheel, "--to", "all", "--limits", "--ros-distro", "jazzy", "-o", "out").code == 0
    )

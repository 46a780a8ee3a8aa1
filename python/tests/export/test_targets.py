# SPDX-License-Identifier: Apache-2.0
"""Every target names its origin and refuses a bad verdict."""

from __future__ import annotations

from dataclasses import fields, replace
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.errors import ModelError, SettingsError
from slipwise.export import TARGETS, ExportOptions, Target, export_model, find_target
from slipwise.export.wheel_multipliers import wheel_multipliers
from slipwise.logs import open_log
from slipwise.models import Model

FITTING = {
    "diff-drive": named("edd-2", ang__w=-0.3),
    "mppi": replace(named("edd-2", ang__w=-0.3), commands=True),
    "amcl": named("edd-2", ang__w=-0.3),
    "robot-localization": replace(named("edd-2", ang__w=-0.3), commands=True),
    "autoware": named("edd-2", ang__w=-0.3),
    "px4": replace(named("edd-2", ang__w=-0.3), commands=True),
    "ardupilot": replace(named("edd-2", ang__w=-0.3), commands=True),
    "c-header": named("edd-2", ang__w=-0.3),
}
VERSIONS = ExportOptions(px4="1.17", ardupilot="4.6", ros_distro="jazzy")


def fitting(target: Target) -> Made:
    return FITTING[target.name]


def test_a_file_names_the_log_the_versions_and_the_verdict(subtests: pytest.Subtests) -> None:
    for target in TARGETS:
        with subtests.test(target=target):
            made = replace(
                fitting(target), log="drives/monday.mcap", sentence="It misses by 3 cm.", identifiable=False
            )
            head = export_model(make_model(made), target.name, name="mine.yaml", options=VERSIONS).text[:1200]
            for words in (
                f"slipwise {version('slipwise')}, model mine.yaml",
                "learned by slipwise 0.2.0",
                "drives/monday.mcap (sha256 abababababababab)",
                "verdict: good. It misses by 3 cm.",
                "speeds -0.5 to 1.5 m/s",
                "not identifiable from the log",
                "ang.w",
            ):
                assert words in head


def test_a_bad_verdict_is_refused_unless_forced(subtests: pytest.Subtests) -> None:
    for target in TARGETS:
        with subtests.test(target=target):
            model = make_model(
                replace(fitting(target), good=False, sentence="It does not beat doing nothing.")
            )
            with pytest.raises(ModelError, match="verdict is bad: It does not beat doing nothing") as caught:
                export_model(model, target.name, name="m.yaml", options=VERSIONS)
            assert "--force" in caught.value.advice
            text = export_model(model, target.name, name="m.yaml", options=VERSIONS, force=True).text
            assert "verdict: NOT GOOD ENOUGH. It does not beat doing nothing." in text


FROM_COMMANDS = ("mppi", "robot-localization", "px4", "ardupilot", "c-header")


def test_a_model_without_an_actuator_model_is_exported(subtests: pytest.Subtests) -> None:
    for target in FROM_COMMANDS:
        with subtests.test(target=target):
            model = make_model(replace(named("edd-2", ang__w=-0.3), delays=(0.1, 0.0)))
            assert "learned by slipwise" in export_model(model, target, name="m.yaml", options=VERSIONS).text


def test_the_kinematic_baseline_is_exported(subtests: pytest.Subtests) -> None:
    for target in TARGETS:
        with subtests.test(target=target):
            model = make_model(Made(_core.Basis("none", [], [], [])))
            name = "command" if target.name in FROM_COMMANDS else "wheel"
            baseline = Model(model.content.model_copy(update={"input": name}))
            assert baseline.motion.size == 0
            made = export_model(baseline, target.name, name="m.yaml", options=VERSIONS)
            assert "learned by slipwise" in made.text


def test_the_same_model_gives_the_same_bytes() -> None:
    first, second = (export_model(make_model(FITTING["amcl"]), "amcl", name="m").text for _ in range(2))
    assert first == second


def test_an_unknown_target_is_refused() -> None:
    with pytest.raises(SettingsError, match="unknown target 'spot'"):
        export_model(make_model(FITTING["amcl"]), "spot", name="m.yaml")


def test_a_model_that_learned_where_its_pose_sensor_sits_is_exported_like_others(
    subtests: pytest.Subtests,
) -> None:
    for target in TARGETS:
        with subtests.test(target=target):
            made = fitting(target)
            options = replace(VERSIONS, wheel_separation=0.5, limits=True)
            mounted = make_model(replace(made, sensor_extrinsics=(0.2, 0.0, 0.1)))
            one, other = (
                export_model(model, target.name, name="m", options=options)
                for model in (mounted, make_model(made))
            )
            if target.name != "c-header":
                assert one.values == other.values
                assert one.kept == other.kept


GIVEN = ExportOptions(
    horizon=3.0,
    wheel_separation=0.5,
    logged_separation_multiplier=1.2,
    logged_radius_multiplier=1.1,
    min_turning_radius=2.0,
    update_rate=50.0,
    planning_horizon=1.5,
    filter_rate=50.0,
    limits=True,
    stamped_commands=True,
    omni=True,
    small_alphas=True,
    wheel_base=2.5,
    input_scale="robot",
    no_side_slip=True,
    px4="1.17",
    ardupilot="4.6",
    logged={"RO_YAW_RATE_CORR": 1.1},
)


@pytest.mark.parametrize(
    ("target", "name", "own"),
    [("px4", "CRUISE_SPEED", "RO_MAX_THR_SPEED"), ("ardupilot", "RO_YAW_RATE_CORR", "ATC_STR_RAT_FF")],
)
def test_a_parameter_of_another_firmware_is_refused(target: str, name: str, own: str) -> None:
    with pytest.raises(SettingsError, match=f"{target} has no {name}.*its own are.*{own}"):
        find_target(target).refuse_others(ExportOptions(logged={name: 1.2}))


def test_what_a_target_does_not_read_changes_nothing_of_its_file_and_is_refused(
    subtests: pytest.Subtests,
) -> None:
    assert set(GIVEN.given()) == {each.name for each in fields(ExportOptions)} - {"ros_distro"}
    for target in TARGETS:
        with subtests.test(target=target):
            model = make_model(fitting(target))
            plain = export_model(model, target.name, name="m", options=VERSIONS).text
            for name in set(GIVEN.given()) - target.reads:
                one = {name: getattr(GIVEN, name)}
                asked = replace(VERSIONS, **one)
                assert export_model(model, target.name, name="m", options=asked).text == plain
                with pytest.raises(
                    SettingsError, match=rf"{target.name} takes no --{name.replace('_', '-')}"
                ):
                    target.refuse_others(ExportOptions(**one))
            target.refuse_others(ExportOptions(ros_distro="jazzy"))


def test_wheels_whose_sensor_was_learned_are_exported_to_autopilots() -> None:
    made = replace(named("edd-2", ang__w=-0.3), sensor_extrinsics=(0.2, 0.0, 0.1))
    options = replace(VERSIONS, wheel_separation=0.5)
    for target in ("px4", "ardupilot"):
        assert export_model(make_model(made), target, name="m", options=options).kept


@pytest.mark.slow
def test_a_log_that_was_read_with_a_scale_asks_whose_numbers_were_wrong(subtests: pytest.Subtests) -> None:
    for target in TARGETS:
        with subtests.test(target.name):
            plain = make_model(fitting(target))
            read_so = with_scale(plain, (0.5, 0.25))
            with pytest.raises(ModelError, match=r"of the log were multiplied by 0\.5 and 0\.25"):
                export_model(read_so, target.name, name="m", options=VERSIONS)
            of_log = replace(VERSIONS, input_scale="log")
            values = export_model(read_so, target.name, name="m", options=of_log).values
            assert values == export_model(plain, target.name, name="m", options=VERSIONS).values


def test_a_robot_that_is_wrong_by_the_scale_of_its_log_gets_multipliers_that_mend_it() -> None:
    plain = make_model(FITTING["diff-drive"])
    read_so, robot = with_scale(plain, (0.5, 0.25)), replace(VERSIONS, input_scale="robot")
    given = replace(VERSIONS, logged_radius_multiplier=0.5, logged_separation_multiplier=2.0)
    values = export_model(read_so, "diff-drive", name="m", options=robot).values
    assert values == export_model(plain, "diff-drive", name="m", options=given).values
    with pytest.raises(ModelError, match="amcl takes the robot's own"):
        export_model(read_so, "amcl", name="m", options=robot)


def with_scale(model: Model, scale: tuple[float, float]) -> Model:
    """Return it as one of a log that was read with a scale."""
    origin = model.content.provenance.model_copy(update={"input_scale": list(scale)})
    return Model(model.content.model_copy(update={"provenance": origin}))


def test_every_file_of_a_husky_on_tile_is_written(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "husky/tile_deflated_tyres.csv.gz")
    settings = make_settings({"basis": "full-linear-6"})
    learned = {name: calibrate(log, input=name, settings=settings).model for name in ("wheel", "command")}
    options = replace(VERSIONS, wheel_separation=0.481)
    for target in TARGETS:
        model = learned["command" if fitting(target).commands else "wheel"]
        exported = export_model(model, target.name, name="husky.yaml", options=options)
        assert "tile_deflated_tyres.csv.gz" in exported.text
        if target.file_name.endswith(".yaml"):
            (node,) = yaml.safe_load(exported.text).values()
            assert node["ros__parameters"]
    found = wheel_multipliers(learned["wheel"], options)
    assert 1.7 < found.separation.value < 2.4  # Clearpath ships 1.875
    assert 0.9 < found.right_radius.value < found.left_radius.value < 1.0  # its tyres were deflated

# SPDX-License-Identifier: Apache-2.0
"""Numbers carry their uncertainty through arithmetic, and what is not known is written by no exporter."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from sample_models import BODY, LIMITS, Made, make_model, named

from slipwise.errors import ModelError
from slipwise.export import ExportOptions, export_model
from slipwise.export.actuator import actuator_of
from slipwise.export.learned_number import LearnedNumbers
from slipwise.models import Model, ModelFile
from slipwise.models.limits import SEPARATION, LearnedLimit

WHEEL = named("edd-2", lon__V=-0.1, ang__w=-0.4)
COMMAND = replace(WHEEL, commands=True)
SEPARATED = ExportOptions(wheel_separation=0.5, ros_distro="jazzy", limits=True)
NEW = ExportOptions(ros_distro="rolling", update_rate=50.0)
FAST = {**BODY, "speed": [-5.0, 5.0], "yaw_rate": [-5.0, 5.0]}
KILTED = ExportOptions(ros_distro="kilted", limits=True)


def changed(made: Made, parameters: Mapping[str, Mapping[str, Any]], *, windows: int = 600) -> Model:
    """Return a model in which some parameters are known worse, independently of the others."""
    content = make_model(made).content.model_dump(mode="json")
    content["provenance"]["learned_segments"] = windows
    for i, parameter in enumerate(content["parameters"]):
        parameter.update(parameters.get(parameter["name"], {}))
        content["covariance"][i][i] = parameter["std"] ** 2
    return Model(ModelFile.model_validate(content))


def exported(model: Model, target: str, options: ExportOptions | None = None) -> Any:
    return export_model(model, target, name="m.yaml", options=options or NEW)


def test_the_standard_deviation_is_that_of_drawn_parameters() -> None:
    model = changed(
        replace(COMMAND, response=True),
        {"log_time_constant_v": {"std": 0.1}, "slow_fraction_v": {"std": 0.05}, "gain_v": {"std": 0.04}},
    )
    numbers, rng = LearnedNumbers(model), np.random.default_rng(3)
    number = actuator_of(model).v.gain * 1.5 / actuator_of(model).v.mean_delay
    names = [p.name for p in model.content.parameters]
    drawn = []
    for values in rng.multivariate_normal(model.mean, model.covariance, 300).tolist():
        v = actuator_of(changed(with_values(dict(zip(names, values, strict=True))), {})).v
        drawn.append(v.gain.value * 1.5 / v.mean_delay.value)
    assert numbers.std(number) == pytest.approx(np.std(drawn), rel=0.15)


def with_values(values: dict[str, float]) -> Made:
    return replace(COMMAND, response=True, values=values)


@pytest.mark.parametrize(("std", "written"), [(0.29, True), (0.31, False)])
def test_three_tenths_of_a_number_is_the_most_it_may_be_unsure(std: float, written: bool) -> None:
    numbers = LearnedNumbers(make_model(WHEEL))
    why = numbers.objection(numbers.limit(LearnedLimit(value=1.0, std=std)))
    assert (why == "") is written
    assert written or "is too uncertain" in why


def test_a_variance_is_known_better_the_more_residuals_a_segment_shows() -> None:
    content = make_model(WHEEL).content.model_dump(mode="json")
    stds = []
    for residuals in (None, 2.0):
        origin = {**content["provenance"], "learned_segments": 16, "residuals_per_segment": residuals}
        numbers = LearnedNumbers(Model(ModelFile.model_validate({**content, "provenance": origin})))
        stds.append(numbers.std(numbers.variance(1.0, guessed=0.0)))
    assert stds == pytest.approx([math.sqrt(2.0 / 16.0), math.sqrt(2.0 / 32.0)])


def test_what_the_log_says_little_about_is_not_written_however_narrow_its_prior_is() -> None:
    model = changed(WHEEL, {"lon.V": {"std": 0.028, "prior_std": 0.03, "identifiable": False}})
    file = exported(model, "diff-drive")
    assert {"left_wheel_radius_multiplier", "right_wheel_radius_multiplier"} <= set(file.kept)
    assert "this log does not determine it" in file.kept["left_wheel_radius_multiplier"]
    assert "wheel_separation_multiplier" in file.values  # its prior was far wider


def test_what_is_known_together_is_written_though_its_parts_are_not() -> None:
    """Lag and delay trade places: each is known badly, their sum well."""
    content = changed(COMMAND, {"log_time_constant_v": {"std": 0.4}, "log_delay_v": {"std": 0.6}}).content
    dump = content.model_dump(mode="json")
    lag, delay = (
        [p.name for p in content.parameters].index(name) for name in ("log_time_constant_v", "log_delay_v")
    )
    dump["covariance"][lag][delay] = dump["covariance"][delay][lag] = -0.99 * 0.4 * 0.6
    together = Model(ModelFile.model_validate(dump))
    assert exported(together, "mppi").values["FollowPath.model_delay_vx"] == pytest.approx(0.5)
    assert "FollowPath.model_delay_vx" in exported(Model(content), "mppi").kept


BADLY = {name: {"std": 0.5} for name in ("lon.V", "ang.w")}
BADLY |= {name: {"std": 2.0} for name in ("log_time_constant_v", "log_time_constant_omega")}
EVERYTHING = (
    ("diff-drive", WHEEL, SEPARATED),
    ("diff-drive", WHEEL, None),
    ("mppi", replace(COMMAND, limits=LIMITS), None),
    ("mppi", replace(COMMAND, limits=LIMITS), KILTED),
    ("mppi", COMMAND, replace(KILTED, min_turning_radius=0.8)),
    ("robot-localization", COMMAND, None),
    ("robot-localization", WHEEL, None),
)
GIVEN = {
    "wheel_separation",
    "publish_rate",
    "FollowPath.motion_model",
    "FollowPath.diff_drive.plugin",
    "frequency",
    "two_d_mode",
    "dynamic_process_noise_covariance",
    "use_control",
}


def test_of_a_model_that_knows_nothing_no_learned_number_is_written(subtests: pytest.Subtests) -> None:
    for target, made, options in EVERYTHING:
        with subtests.test(target=target, made=made, options=options):
            limits = make_model(made).table.of("limits").names
            badly = BADLY | {name: {"std": 1.3e7} for name in limits if name != SEPARATION}
            model = changed(made, badly, windows=10)
            before = set(exported(make_model(made), target, options).values)
            file = exported(model, target, options)
            left = {
                name for name in set(file.values) - GIVEN if "velocity" not in name and name not in MEASURED
            }
            if target == "robot-localization":  # all fifteen stay at the filter's own
                assert re.search(r"x and y too: .* is too uncertain", file.text)
                left -= {"process_noise_covariance"}
            assert left == set()
            assert set(file.kept) >= before - set(file.values) - {"process_noise_covariance"} - CONTROL
            for name, why in file.kept.items():
                assert f"# {name} is not written, its default stays:\n" in file.text
                assert why[:40] in file.text
            assert yaml.safe_load(file.text)


#: What the poses show, however little was learned.
MEASURED = {"FollowPath.vx_max", "FollowPath.vx_min", "FollowPath.wz_max"}
CONTROL = {
    "control_config",
    "acceleration_gains",
    "deceleration_gains",
    "acceleration_limits",
    "deceleration_limits",
}


def test_amcl_gets_no_alphas_from_ten_windows() -> None:
    with pytest.raises(ModelError, match=r"no alpha of AMCL can be written: .* is too uncertain"):
        exported(changed(WHEEL, {}, windows=10), "amcl")
    options = ExportOptions(omni=True, small_alphas=True)
    values = exported(changed(WHEEL, {}, windows=30), "amcl", options).values
    assert set(values) >= {f"alpha{i}" for i in range(1, 6)}


def test_an_alpha_that_is_the_prior_of_a_parameter_is_no_alpha() -> None:
    model = changed(WHEEL, {"ang.w": {"std": 0.29, "identifiable": False}})
    file = exported(model, "amcl", ExportOptions(small_alphas=True))
    assert "this log does not determine it" in file.kept["alpha1"]
    assert "alpha3" in file.values
    omni = exported(model, "amcl", ExportOptions(omni=True, small_alphas=True))
    assert "this log does not determine it" in omni.kept["alpha1"]  # nor for the other sample model


def test_the_filter_controls_only_the_speed_whose_lag_is_known() -> None:
    file = exported(changed(COMMAND, {"log_time_constant_omega": {"std": 0.5}}), "robot-localization")
    assert file.values["control_config"] == [True, False, False, False, False, False]
    assert file.values["acceleration_gains"] == pytest.approx([1.0 / 0.3, 0, 0, 0, 0, 0])
    assert "not the yaw rate: 0.30 +- 0.15 is too uncertain" in file.text


def test_limits_of_the_sides_are_folded_into_those_of_the_body() -> None:
    """The strictest of what is known counts; one that is not known does not."""
    limits = {
        "speed": {"slew_rate_up": 12.5},
        "side": {"slew_rate_up": 1.67, "slew_rate_down": 2.0, "saturation": 1.2},
    }
    made = replace(COMMAND, limits=limits, body=FAST)
    model = changed(made, {"limits.speed.slew_rate_up": {"std": 1.3e7}})
    values = {k.removeprefix("FollowPath."): v for k, v in exported(model, "mppi", KILTED).values.items()}
    separation = model[SEPARATION].value
    assert values["ax_max"] == pytest.approx(0.9 * 1.67)
    assert values["ax_min"] == pytest.approx(-0.9 * 2.0)
    assert values["az_max"] == pytest.approx(0.6 * 2.0 * 1.67 / separation)
    rates = exported(model, "robot-localization").values["acceleration_limits"]
    assert rates[0] <= 1.67
    assert rates[5] <= 2.0 * 1.67 / separation


def test_a_body_faster_than_its_sides_is_not_counted_on() -> None:
    made = replace(
        named("edd-2", lon__V=0.1), commands=True, limits={"side": {"slew_rate_up": 1.67}}, body=FAST
    )
    assert exported(make_model(made), "mppi", KILTED).values["FollowPath.ax_max"] == pytest.approx(1.67)


def test_the_c_header_says_what_is_not_identified_and_stays_the_model() -> None:
    made = replace(COMMAND, limits={"speed": {"slew_rate_up": 12.5, "saturation": 1.0}})
    badly = {"log_time_constant_v": {"std": 0.9}, "limits.speed.slew_rate_up": {"std": 1.3e7}}
    model = changed(made, badly)
    lines = exported(model, "c-header").text.splitlines()
    (lag,) = (line for line in lines if line.startswith("#define SLIPWISE_TIME_CONSTANT_V "))
    (other,) = (line for line in lines if line.startswith("#define SLIPWISE_TIME_CONSTANT_OMEGA "))
    assert "not identified" in lag
    assert f"SLIPWISE_R({math.exp(model.mean[2])!r})" in lag
    assert "0.300 +- 0.003" in other
    assert "not identified" not in other
    assert "/* limits.speed.slew_rate_up, 12.5 +- 1.3e+07, not identified */" in lines
    assert "/* limits.speed.saturation, 1.000 +- 0.010 */" in lines


def test_what_a_turned_sensor_would_change_is_not_written_and_said_with_what_it_would_be() -> None:
    """A body that goes 0.95 of its wheels, by poses that are turned by 20 degrees to the left."""
    cos, sin = math.cos(math.radians(20.0)), math.sin(math.radians(20.0))
    turned = named("full-linear-6", lon__V=0.95 * cos - 1.0, lat__V=-0.95 * sin, ang__w=-0.3)
    file = exported(make_model(replace(turned, std=0.002)), "diff-drive", SEPARATED)
    assert not {name for name in file.values if "multiplier" in name}
    why = file.kept["left_wheel_radius_multiplier"]
    assert re.search(
        r", or 0\.95 if it is turned by 20\.0\d* \+- 0\.1\d* deg, as --set sensor_ext\S*yaw=0\.35", why
    )
    slight = named("full-linear-6", lon__V=-0.05, lat__V=-0.07, ang__w=-0.3)  # 0.3 % of the radius
    assert (
        "left_wheel_radius_multiplier"
        in exported(make_model(replace(slight, std=0.002)), "diff-drive", SEPARATED).values
    )

# SPDX-License-Identifier: Apache-2.0
"""`slipwise doctor` names what is wrong in each input from the field, and nothing where nothing is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result
from field.conftest import FieldLog

Slipwise = Callable[..., Result]

JOINTS = ("--wheel-radius", "0.033", "--wheel-separation", "0.16")
#: What is found in each file, with a piece of the evidence and one of the cure.
WANTED: dict[str, dict[str, tuple[str, str]]] = {
    "roll_0_2pi_crash.csv": {},
    "tilt_in_degrees.csv": {"tilt-in-degrees": ("up to 2.86", "radians")},
    "imu_roll_90.mcap": {"tilted-sensor": ("about 90 deg of roll", "static transform")},
    "two_robots_mixed.mcap": {"other-robot": ("/r2/odom is not used", "--wheel-topic /r2/odom")},
    "joints_arm_alternates.mcap": {"no-wheel-joint": ("600 x messages of /joint_states", "--left-joints")},
    "lio_and_joints.mcap": {},
    "header_jumps_receipt_fine.mcap": {
        "clock-set-back": ("by 9.9 s", "new run"),
        "clock-apart": ("10.00 s behind", "TwistStamped"),
    },
    "sim_clock_mixed.mcap": {"clock-rate": ("at 0.8 of the bag's clock: /cmd_vel", "use_sim_time")},
    "cmd_timeout.mcap": {"command-timeout": ("every 1.3 s", "--command-timeout 0.5")},
    "cog_heading_flip.mcap": {"course-heading": ("half a turn when the robot reverses", "heading")},
    "wheel_twist_zero.mcap": {"zero-twist": ("/odom is always zero", "differences of its poses")},
    "quat_zero_always.mcap": {"no-rotation": ("all 400 poses", "only their positions")},
    "yaw_wrap_spike_3hz.mcap": {"wheel-spikes": ("wheel speeds jump", "Unwrap")},
    "unrelated_wheels.csv": {"unrelated": ("the wheels do not explain the poses", "one robot")},
    "antenna_with_imu.mcap": {"sensor-off-centre": ("0.45 m ahead", "sensor_extrinsics.x=0.45")},
    "wheels_10hz.csv.gz": {},
    "wheels_rad_per_min.csv": {"implausible": ("0.0031 times as far", "--wheel-scale")},
    "split_one_lost": {"missing-file": ("split_1.mcap", "whole folder")},
    "odometry.dat": {},
    "cov_xy_1e308.mcap": {},
}
OPTIONS: dict[str, tuple[object, ...]] = {
    "joints_arm_alternates.mcap": JOINTS,
    "lio_and_joints.mcap": ("--pose-topic", "/Odometry", *JOINTS),
    "odometry.dat": ("--columns", "t=0,odo_v=1,odo_omega=2"),
}


def test_each_input_of_the_field_is_diagnosed(
    slipwise: Slipwise, field_log: FieldLog, subtests: pytest.Subtests
) -> None:
    for name, wanted in WANTED.items():
        with subtests.test(name=name):
            poses = ("--poses", field_log("truth_tum.txt")) if name == "odometry.dat" else ()
            result = slipwise("doctor", field_log(name), *OPTIONS.get(name, ()), *poses, "--json", "-")
            found = {each["kind"]: each for each in result.json["logs"][0]["findings"]}
            assert found.keys() == wanted.keys()
            assert result.code == int(bool(wanted))
            for kind, (evidence, cure) in wanted.items():
                assert evidence in found[kind]["sentence"]
                assert cure in " ".join((found[kind]["sentence"], *found[kind]["advice"]))


def test_what_is_no_log_is_an_error(slipwise: Slipwise, field_log: FieldLog) -> None:
    result = slipwise("doctor", field_log("truth_tum.txt"))
    assert result.code == 2
    assert "this is a TUM pose file" in result.line


def test_inspect_calibrate_and_live_say_what_the_doctor_says(
    slipwise: Slipwise, field_log: FieldLog, folder: Path
) -> None:
    log = field_log("yaw_wrap_spike_3hz.mcap")
    said = "wheel speeds jump far beyond all others for one sample"
    for command in (("doctor",), ("inspect",), ("calibrate", "--input", "wheel", "--no-report")):
        assert said in " ".join(slipwise(command[0], log, *command[1:]).out.split())
    live = slipwise("live", "--replay", log, "--rate", "0", "-o", "live.yaml", "--set", "live.input=wheel")
    assert "a counter wraps or is reset" in live.out + live.err

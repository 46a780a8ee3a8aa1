# SPDX-License-Identifier: Apache-2.0
"""What a user says of scales, signs and headings is applied once, noted, and cures the log."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import scaled, sound_log, turned, with_poses

from slipwise.calibration import make_settings
from slipwise.errors import SettingsError
from slipwise.logs import Log, LogOptions, open_log
from slipwise.logs.corrections import scaled_inputs, turned_poses
from slipwise.logs.findings.checks import findings_of


def corrected(log: Log, options: LogOptions) -> Log:
    return turned_poses(scaled_inputs(log, options), options)


def test_without_options_the_log_is_as_it_was() -> None:
    log = sound_log()
    assert corrected(log, LogOptions()) is log


@pytest.mark.parametrize(
    ("name", "factor", "options"),
    [
        ("commands", 1.0 / 0.15, LogOptions(command_scale=(0.15, 1.0))),
        ("commands", -1.0, LogOptions(command_scale=(-1.0, 1.0))),
        ("wheels", 1.0 / 0.15, LogOptions(wheel_scale=(0.15, 1.0))),
    ],
)
def test_a_scale_gives_the_sound_log_back(name: str, factor: float, options: LogOptions) -> None:
    cured = corrected(scaled(sound_log(), name, factor), options)
    expected, got = (getattr(log.runs[0], name) for log in (sound_log(), cured))
    np.testing.assert_allclose(got.v, expected.v, atol=1e-12)
    np.testing.assert_array_equal(got.omega, expected.omega)
    assert cured.notes[0].startswith(f"{name}: speed times ")
    assert findings_of(cured, name.removesuffix("s")) == ()


@pytest.mark.parametrize("angle", [np.pi, 0.5 * np.pi, -0.5 * np.pi])
def test_a_yaw_offset_gives_the_sound_log_back(angle: float) -> None:
    cured = corrected(turned(sound_log(), angle), LogOptions(pose_yaw_offset=-angle))
    difference = cured.runs[0].poses.yaw - sound_log().runs[0].poses.yaw
    np.testing.assert_allclose(np.sin(difference), 0.0, atol=1e-9)
    assert "rad added to every heading" in cured.notes[0]
    assert findings_of(cured, "wheel") == ()


def test_poses_of_all_sources_are_turned_and_shifted(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,{0.01 * (k % 7):.2f},{'ab'[k % 2]}" for k in range(100)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    (one,) = open_log(tmp_path / "a.csv").runs
    (other,) = open_log(tmp_path / "a.csv", pose_yaw_offset=0.4, pose_clock_offset=-0.2).runs
    for before, after in ((one.poses, other.poses), (one.others["b"], other.others["b"])):
        np.testing.assert_allclose(after.yaw - before.yaw, 0.4)
        np.testing.assert_allclose(after.t - before.t, -0.2)


@pytest.mark.parametrize(("turn", "options"), [("cmd_curvature", {}), ("cmd_steer", {"wheelbase": 0.5})])
def test_a_robot_that_steers_turns_with_the_speed_as_it_is_corrected(
    turn: str, options: dict[str, float], tmp_path: Path
) -> None:
    rows = [f"{0.1 * k:.1f},{3.6 + k % 5},{0.2 * (k % 3)},{0.1 * k:.1f},0,0" for k in range(50)]
    (tmp_path / "a.csv").write_text("\n".join([f"t,cmd_v,{turn},x,y,yaw", *rows, ""]))
    as_it_is, corrected = (
        open_log(tmp_path / "a.csv", command_scale=scale, **options).runs[0].commands
        for scale in ((1.0, 1.0), (1.0 / 3.6, 1.0))
    )
    assert as_it_is is not None
    assert corrected is not None
    np.testing.assert_allclose(corrected.v, as_it_is.v / 3.6)
    np.testing.assert_allclose(corrected.omega, as_it_is.omega / 3.6)


def test_roll_and_pitch_are_turned_with_the_sensor() -> None:
    size = len(sound_log().runs[0].poses)
    nose_down = with_poses(sound_log(), lambda p: replace(p, roll=np.zeros(size), pitch=np.full(size, 0.1)))
    backwards = corrected(nose_down, LogOptions(pose_yaw_offset=np.pi)).runs[0].poses
    sideways = corrected(nose_down, LogOptions(pose_yaw_offset=0.5 * np.pi)).runs[0].poses
    assert backwards.pitch is not None
    assert sideways.roll is not None
    assert sideways.pitch is not None
    np.testing.assert_allclose(backwards.pitch, -0.1, atol=1e-12)
    np.testing.assert_allclose(sideways.pitch, 0.0, atol=1e-12)
    np.testing.assert_allclose(sideways.roll, 0.1, atol=1e-12)  # what was ahead is on the right


def test_positions_have_no_heading_to_turn(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0" for k in range(50)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y", *rows, ""]))
    with pytest.raises(SettingsError, match=r"only positions.*--pose-yaw-offset"):
        open_log(tmp_path / "a.csv", pose_yaw_offset=1.0)


@pytest.mark.parametrize(
    "options", [{"command_scale": (0.0, 1.0)}, {"wheel_scale": (1.0,)}, {"pose_yaw_offset": float("nan")}]
)
def test_impossible_corrections_are_refused(options: dict[str, tuple[float, ...]]) -> None:
    with pytest.raises(SettingsError, match=next(iter(options)).replace("_", "-")):
        LogOptions(**options)  # type: ignore[arg-type]


def test_settings_hold_them_too_and_the_command_line_goes_before() -> None:
    settings = make_settings({"log": {"wheel_scale": [-1.0, 1.0], "pose_yaw_offset": 1.5}})
    assert settings.log_options() == LogOptions(wheel_scale=(-1.0, 1.0), pose_yaw_offset=1.5)
    assert settings.log_options(wheel_scale=(2.0, 1.0)).wheel_scale == (2.0, 1.0)

# SPDX-License-Identifier: Apache-2.0
"""The plug-in for Nav2's MPPI compiles against stand-ins, fills in the learned motion, and exchanges models.

Nav2 and rclcpp are not at hand here: nothing in these tests says that they load the plug-in.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import cmeel
import numpy as np
import pytest
import yaml
from sample_models import LIMITS, Made, make_model, named

from slipwise.export import export_model
from slipwise.models import Model
from slipwise.planning import Start, rollout

ROOT = Path(__file__).resolve().parents[3]
STAND_IN = Path(__file__).resolve().parent / "stand_in"
PACKAGE = ROOT / "integrations/nav2/slipwise_mppi_motion_model"
LIBRARY = ROOT / "build/package/libslipwise.a"
EIGEN = Path(next(iter(cmeel.__path__))).parent / "cmeel.prefix/include/eigen3"
DT, ROLLOUTS, PERIODS = 0.05, 3, 12


def compiled(program: str, folder: Path, ros_python: Path, *flags: str) -> Path:
    """Compile a program of the stand-in with the messages of a real ROS 2; return where it is."""
    assert LIBRARY.is_file(), "`make build` compiles the library"
    includes = [f"-I{path}" for path in (folder, STAND_IN, PACKAGE / "src", ROOT / "cpp/include")]
    messages = [f"-isystem{path}" for path in (ros_python.parents[1] / "include").iterdir() if path.is_dir()]
    subprocess.run(
        [
            *(os.environ.get("CXX", "c++"), "-std=c++20", "-Wall", "-Wextra", "-Werror", *flags),
            *(*includes, *messages, f"-isystem{EIGEN}", STAND_IN / f"{program}.cpp", LIBRARY),
            *("-pthread", "-o", folder / program),
        ],
        check=True,
    )
    return folder / program


def filled_in(model: Model, folder: Path, ros_python: Path) -> np.ndarray:
    """Return forward and sideways speed and yaw rate [N, K, 3] that the plug-in filled in."""
    (folder / "model.h").write_text(export_model(model, "c-header", name="m.yaml").text, encoding="utf-8")
    program = compiled("drive_plugin", folder, ros_python)
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    assert lines[0] == "0"  # not holonomic
    return np.array([line.split() for line in lines[1:]], dtype=np.float64).reshape(ROLLOUTS, PERIODS, 3)


@pytest.mark.slow
@pytest.mark.parametrize("limits", [None, {"speed": LIMITS["speed"]}])
def test_what_nav2_would_add_up_is_the_learned_path(
    limits: dict[str, dict[str, float]] | None, tmp_path: Path, ros_python: Path
) -> None:
    made = Made(
        named("odd-even-10").basis,
        {"lon.V": -0.1, "ang.w": -0.3, "lat.V*w": 0.2},
        commands=True,
        limits=limits,
    )
    model = make_model(made)
    velocities = filled_in(model, tmp_path, ros_python)
    n, k = np.meshgrid(np.arange(ROLLOUTS), np.arange(PERIODS), indexing="ij")
    commands = np.stack((0.5 + 0.02 * n * k, 0.1 * (n - 1.0)), axis=2).astype(np.float32)
    published_v, published_w = [0.2, 0.3, 0.4, 0.5], [-0.2, -0.25]  # of delays of four and two periods
    past = np.column_stack((published_v, [published_w[0]] * 2 + published_w))
    start = Start(drive=(0.3, -0.1), past=past)
    path = rollout(model, commands, DT, start=start).path
    assert path is not None
    x, y, yaw = np.zeros((3, ROLLOUTS))
    for period in range(PERIODS):
        vx, vy, wz = velocities[:, period].T
        x, y = x + (vx * np.cos(yaw) - vy * np.sin(yaw)) * DT, y + (vx * np.sin(yaw) + vy * np.cos(yaw)) * DT
        yaw = yaw + wz * DT
        np.testing.assert_allclose(np.stack((x, y, yaw)), path[:, period], atol=2e-5)


@pytest.mark.slow
def test_a_thousand_models_are_exchanged_while_it_predicts_and_no_bad_one_drives(
    tmp_path: Path, ros_python: Path
) -> None:
    program = compiled("exchange_models", tmp_path, ros_python, "-fsanitize=thread", "-g", "-O1")
    done = subprocess.run([program], capture_output=True, text=True, timeout=120.0, check=False)
    assert done.returncode == 0, done.stderr
    assert "ThreadSanitizer" not in done.stderr
    assert done.stdout.endswith("1000 of 1000 models were driven\n")


def test_the_packages_description_names_the_class_that_is_exported() -> None:
    source = (PACKAGE / "src/learned_motion_model.cpp").read_text(encoding="utf-8")
    assert len(source.splitlines()) < 100
    assert 'type="slipwise_nav2::LearnedMotionModel"' in (PACKAGE / "plugins.xml").read_text(encoding="utf-8")
    assert "PLUGINLIB_EXPORT_CLASS(slipwise_nav2::LearnedMotionModel, mppi::MotionModel)" in source
    version = next(
        line for line in (ROOT / "pyproject.toml").read_text().splitlines() if line.startswith("version")
    )
    assert version.split('"')[1] in (PACKAGE / "package.xml").read_text(encoding="utf-8")


def test_the_parameters_of_the_page_are_read_by_yaml() -> None:
    page = (ROOT / "docs/use-it-in-your-planner.md").read_text(encoding="utf-8")
    block = next(block for block in page.split("```yaml\n")[1:] if "LearnedMotionModel" in block)
    follow = yaml.safe_load(block.split("```")[0])["controller_server"]["ros__parameters"]["FollowPath"]
    assert follow[follow["motion_model"]]["plugin"] == "slipwise_nav2::LearnedMotionModel"

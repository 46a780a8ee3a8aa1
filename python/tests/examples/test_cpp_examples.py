# SPDX-License-Identifier: Apache-2.0
"""The C++ examples are built as their users build them: with the installed library."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.export import export_model
from slipwise.logs.write_tidy import write_csv
from slipwise.models import load_model
from slipwise.segments import recording_of

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = ROOT / "examples/planner"
BUILT = ROOT / "build/package"

pytestmark = pytest.mark.slow


def run(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, env=os.environ).stdout


def built(source: Path, folder: Path) -> Path:
    """Build an example with the installed library; return the folder of its program."""
    assert (BUILT / "libslipwise.a").is_file(), "`make build` compiles the library"
    run("cmake", "--install", BUILT, "--prefix", folder / "installed")
    prefixes = f"-DCMAKE_PREFIX_PATH={folder / 'installed'};{eigen_prefix()}"
    run("cmake", "-S", source, "-B", folder / "build", "-G", "Ninja", prefixes)
    run("cmake", "--build", folder / "build")
    return folder / "build"


def test_the_planner_of_the_page_finds_the_best_command(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE, tmp_path / "planner")
    header = export_model(load_model(EXAMPLE / "model.yaml"), "c-header", name="model.yaml").text
    (tmp_path / "planner/model.h").write_text(header, encoding="utf-8")
    assert "best: " in run(built(tmp_path / "planner", tmp_path) / "planner")


def test_the_live_learner_learns_what_calibrate_learns(tmp_path: Path) -> None:
    log = simulated_log(Drive(seconds=120.0, lag=0.2, delay=0.1))
    write_csv(log, tmp_path / "run.csv")
    program = built(ROOT / "examples/live_learner", tmp_path) / "live_learner"
    with (tmp_path / "run.csv").open(encoding="utf-8") as rows:
        said = subprocess.run([program], check=True, capture_output=True, text=True, stdin=rows).stdout
    learner = _core.MotionLearner(_core.LearnerSettings())
    learner.start_run()
    learner.push(recording_of(replace(log.runs[0], wheels=None)))
    model = learner.model()
    printed = [float(line.split()[1]) for line in said.splitlines()[:-1]]
    assert printed == pytest.approx(model.motion.estimate.mean, abs=6e-5)
    assert f"{model.segments} segments; 5 s ahead" in said


def test_the_robot_learns_goes_on_from_its_state_and_sets_a_broken_one_aside(tmp_path: Path) -> None:
    program = built(ROOT / "examples/robot", tmp_path) / "robot"
    state = tmp_path / "learner.state"
    first = run(program, state, "60").splitlines()
    assert len(first) == 60
    assert "lon.V" not in first[0]
    second = run(program, state, "60").splitlines()
    assert second[0] == f"goes on from {state}"
    assert "lon.V -0.1" in second[1]
    off = [float(line.split(" m off")[0].split()[-1]) for line in second[1:]]
    assert max(off) < 0.1
    assert not any("stuck" in line for line in first + second)
    state.write_bytes(b"broken")
    assert run(program, state, "1").splitlines()[0].startswith(f"{state} is left aside: ")


def eigen_prefix() -> Path:
    import cmeel

    return Path(next(iter(cmeel.__path__))).parent / "cmeel.prefix"

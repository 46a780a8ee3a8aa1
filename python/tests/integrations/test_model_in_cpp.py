# SPDX-License-Identifier: Apache-2.0
"""A C++ program reads model files: the numbers that Python reads, and clear words for what is none."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import cmeel
import numpy as np
import pytest
from sample_logs import simulated_log
from sample_models import LIMITS, Made, make_model, named
from scripted_node import SLIP

import slipwise as sw
from slipwise import _core
from slipwise.models import Model

ROOT = Path(__file__).resolve().parents[3]
PREFIX = Path(next(iter(cmeel.__path__))).parent / "cmeel.prefix"
LIBRARY = ROOT / "build/package/libslipwise.a"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def read_model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the program with yaml-cpp."""
    assert LIBRARY.is_file(), "`make build` compiles the library"
    program = tmp_path_factory.mktemp("cpp") / "read_model"
    sources = (Path(__file__).with_name("read_model.cpp"), ROOT / "cpp/yaml/parse_model_file.cpp")
    subprocess.run(
        [
            *(os.environ.get("CXX", "c++"), "-std=c++20", "-Wall", "-Wextra", "-Wconversion", "-Werror"),
            *(f"-I{ROOT / 'cpp/include'}", f"-isystem{PREFIX / 'include/eigen3'}"),
            *(f"-isystem{PREFIX / 'include'}", *sources, LIBRARY, f"-L{PREFIX / 'lib'}", "-lyaml-cpp"),
            *(f"-Wl,-rpath,{PREFIX / 'lib'}", "-pthread", "-o", program),
        ],
        check=True,
    )
    return program


def limits_of(model: Model) -> list[float]:
    none = _core.AxisLimits()
    limits = model.limits or _core.CommandLimits(none, none, none, 1.0, 1.0, 1.0)
    axes = (limits.speed, limits.yaw_rate, limits.side)
    rows = [(each.dead_band, each.saturation, each.slew_rate_up, each.slew_rate_down) for each in axes]
    return [*np.ravel(rows).tolist(), limits.wheel_separation, limits.gain_v, limits.gain_omega]


def models() -> dict[str, Model]:
    learned = sw.calibrate(simulated_log(SLIP))
    return {
        "limits": make_model(Made(named("odd-even-10").basis, {"lon.V": -0.1}, commands=True, limits=LIMITS)),
        "from wheels": make_model(named("edd-2")),
        "learned": learned.model,
    }


def test_cpp_reads_the_numbers_that_python_reads(read_model: Path, tmp_path: Path) -> None:
    for name, model in models().items():
        path = model.save(tmp_path / "model.yaml")
        done = subprocess.run([read_model, path], capture_output=True, text=True, check=False)
        assert done.returncode == 0, (name, done.stderr)
        head, limits, parameters, covariance = (line.split() for line in done.stdout.splitlines())
        body = model.body
        assert head == [
            model.content.input,
            str(int(model.verdict.good)),
            str(body.motion.size),
            f"{body.motion.wheelbase:.17g}",
        ], name
        assert [float(text) for text in limits] == limits_of(body), name
        assert [float(text) for text in parameters] == body.mean.tolist(), name
        assert [float(text) for text in covariance] == body.covariance.ravel("F").tolist(), name


def test_what_is_no_model_is_refused_in_words(read_model: Path, tmp_path: Path) -> None:
    whole = make_model(named("edd-2")).to_yaml()
    texts = {
        "": "no model file of schema 5",
        "a: [1": "the text is no model file",
        "[" * 100_000: "the text is no model file",
        whole.replace("slipwise_model: 5", "slipwise_model: 4"): "no model file of schema 5",
        whole.replace("covariance:", "other:"): "is the file or message whole?",
        whole.replace("input:", "output:"): "the text is no model file",
        whole.replace("lon.V", "lon.V", 1).replace("lon: [V", "lon: [nonsense"): "nonsense",
    }
    for text, words in texts.items():
        path = tmp_path / "model.yaml"
        path.write_text(text)
        done = subprocess.run([read_model, path], capture_output=True, text=True, check=False)
        assert (done.returncode, words in done.stderr) == (1, True), (text[:40], done)

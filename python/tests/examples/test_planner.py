# SPDX-License-Identifier: Apache-2.0
"""The C++ example is built as its page says: with the installed library and an exported header."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from slipwise.export import export_model
from slipwise.models import load_model

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = ROOT / "examples/planner"
BUILT = ROOT / "build/package"

pytestmark = pytest.mark.slow


def run(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, env=os.environ).stdout


def test_the_planner_of_the_page_finds_the_best_command(tmp_path: Path) -> None:
    assert (BUILT / "libslipwise.a").is_file(), "`make build` compiles the library"
    run("cmake", "--install", BUILT, "--prefix", tmp_path / "installed")
    shutil.copytree(EXAMPLE, tmp_path / "planner")
    header = export_model(load_model(EXAMPLE / "model.yaml"), "c-header", name="model.yaml").text
    (tmp_path / "planner/model.h").write_text(header, encoding="utf-8")
    prefixes = f"-DCMAKE_PREFIX_PATH={tmp_path / 'installed'};{eigen_prefix()}"
    run("cmake", "-S", tmp_path / "planner", "-B", tmp_path / "build", "-G", "Ninja", prefixes)
    run("cmake", "--build", tmp_path / "build")
    said = run(tmp_path / "build/planner")
    assert "best: " in said


def eigen_prefix() -> Path:
    import cmeel

    return Path(next(iter(cmeel.__path__))).parent / "cmeel.prefix"

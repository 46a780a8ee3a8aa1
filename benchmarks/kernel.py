# SPDX-License-Identifier: Apache-2.0
"""Builds the C++ benchmarks in Release mode and runs each of them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PRESET = "release"


def build(names: list[str], preset: str = PRESET) -> Path:
    """Build the benchmarks; return the folder that they are in."""
    environment = os.environ | {"VIRTUAL_ENV": sys.prefix}  # where the Eigen headers and cmake are
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    for command in (
        ["cmake", "--preset", preset],
        ["cmake", "--build", "--preset", preset, "--target", *names],
    ):
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return ROOT / "build" / preset


def main() -> int:
    """Build and run all C++ benchmarks."""
    names = sorted(path.stem for path in ROOT.glob("cpp/benchmarks/*/*.cpp"))
    folder = build(names)
    for name in names:
        subprocess.run([str(folder / name)], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

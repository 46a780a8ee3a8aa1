# SPDX-License-Identifier: Apache-2.0
"""The tuning constants of the core's sources, and a build of the core that reads factors of them.

A constant that is declared by SLIPWISE_TUNING (`linear/tuning.hpp`) is an ordinary one but in this build.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "sensitivity"
_DECLARED = re.compile(r"^(?:inline )?SLIPWISE_TUNING\((k\w+), (.+?)\);(?:\s*//[/<]*\s*(.*))?$", re.MULTILINE)


@dataclass(frozen=True)
class TuningConstant:
    """A constant as its source declares it."""

    name: str  # file.kName
    value: str
    meaning: str


def tuning_constants(root: Path = ROOT) -> list[TuningConstant]:
    """Return all tuning constants, by file and place in it."""
    return [
        TuningConstant(f"{path.stem}.{name}", re.sub(r"std::size_t\{(.+)\}", r"\1", value), meaning)
        for path in sorted((root / "cpp").rglob("*.?pp"))
        if path.name != "tuning.hpp"
        for name, value, meaning in _DECLARED.findall(path.read_text(encoding="utf-8"))
    ]


def build_tuned_core() -> Path:
    """Build the core that reads factors of tuning constants, as far as it is not built; return its path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "VIRTUAL_ENV": sys.prefix}
    configure = [
        "-S",
        ROOT,
        "-B",
        BUILD,
        "-G",
        "Ninja",
        "-DCMAKE_BUILD_TYPE=Release",
        "-DSLIPWISE_SENSITIVITY=ON",
    ]
    for arguments in (
        [*configure, f"-DPython_EXECUTABLE={sys.executable}"],
        ["--build", BUILD, "--target", "_core"],
    ):
        done = subprocess.run(
            ["cmake", *map(str, arguments)], capture_output=True, text=True, check=False, env=environment
        )
        if done.returncode != 0:
            raise SystemExit(
                f"the core with tuning constants cannot be built:\n{(done.stdout + done.stderr)[-2000:]}"
            )
    return next(BUILD.glob("_core*.so"))

# SPDX-License-Identifier: Apache-2.0
"""Installs the wheel of a folder into an empty environment, learns a model with it and replays a log live."""

from __future__ import annotations

import csv
import math
import os
import subprocess
import sys
import tempfile
import time
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STEP = 0.05  # s between rows of the log
SECONDS = 60.0  # length of the log
TURNS = 0.8  # the robot's yaw rate as a fraction of the commanded one
LAG = 0.2  # s, of speed and yaw rate behind their commands
COMMANDS = ((1.0, 0.4), (0.5, -0.5), (1.2, 0.0), (0.8, 0.6), (0.4, -0.3), (1.0, -0.6))  # m/s, rad/s


def the_wheel(folder: Path) -> Path:
    """Return the one wheel in `folder`.

    Raises:
        ValueError: there is none, or more than one.
    """
    wheels = sorted(folder.glob("slipwise-*.whl"))
    if len(wheels) != 1:
        raise ValueError(f"{folder} holds {len(wheels)} wheels of slipwise, not one")
    return wheels[0]


def write_log(path: Path) -> None:
    """Write the drive of a robot that turns less than commanded, with lag: commands and poses as CSV."""
    x = y = yaw = speed = rate = 0.0
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(("t", "x", "y", "yaw", "cmd_v", "cmd_omega"))
        for i in range(round(SECONDS / STEP)):
            command_v, command_omega = COMMANDS[int(i * STEP / 2.5) % len(COMMANDS)]
            table.writerow(f"{value:.4f}" for value in (i * STEP, x, y, yaw, command_v, command_omega))
            speed += (command_v - speed) * STEP / LAG
            rate += (TURNS * command_omega - rate) * STEP / LAG
            yaw += rate * STEP
            x += speed * math.cos(yaw) * STEP
            y += speed * math.sin(yaw) * STEP


def said(command: list[str | Path], folder: Path) -> str:
    """Run `command` in `folder`, without other environments, and return what it says.

    Raises:
        ValueError: the command failed; the message holds what it said.
    """
    away = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "PIP_CONSTRAINT", "PIP_BUILD_CONSTRAINT")
    variables = {name: value for name, value in os.environ.items() if name not in away}
    done = subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(
            f"'{' '.join(map(str, command))}' returned {done.returncode}:\n{done.stdout}{done.stderr}"
        )
    return done.stdout


def try_wheel(wheel: Path, folder: Path) -> str:
    """Install `wheel` with its dependencies below `folder`, use it, and return the version that it tells.

    Raises:
        ValueError: a command failed, or the version is not that of pyproject.toml.
    """
    home = folder / "environment"
    venv.create(home, with_pip=True)
    python, slipwise = home / "bin/python", home / "bin/slipwise"
    pins = ("--constraint", ROOT / "constraints.txt")
    wheels = [wheel.resolve(), *sorted(wheel.parent.resolve().glob("slipwise_sim-*.whl"))]
    said([python, "-m", "pip", "install", "--quiet", *pins, *wheels], folder)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = said([slipwise, "--version"], folder).strip()
    if version != f"slipwise {project['version']}":
        raise ValueError(f"the wheel says '{version}', pyproject.toml {project['version']}")
    where = said([python, "-c", "import slipwise; print(slipwise.__file__)"], folder).strip()
    if not Path(where).resolve().is_relative_to(home.resolve()):
        raise ValueError(f"slipwise was imported from {where}, not from the wheel")
    write_log(folder / "drive.csv")
    said([slipwise, "calibrate", "drive.csv", "-o", "model.yaml"], folder)
    said([slipwise, "show", "model.yaml"], folder)
    said([slipwise, "live", "--replay", "drive.csv", "--rate", "0", "-q"], folder)
    if len(wheels) > 1:
        said([slipwise, "demo", "--duration", "90", "--output", "demo"], folder)
    return version


def main(folder: Path) -> int:
    """Try the wheel in `folder` and say in a line how that went."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        try:
            wheel = the_wheel(folder)
            version = try_wheel(wheel, Path(scratch))
        except (OSError, ValueError, subprocess.CalledProcessError) as error:
            print(f"error: the wheel does not work: {error}", file=sys.stderr)
            return 1
    seconds, size = time.monotonic() - start, wheel.stat().st_size / 1e6
    done = "installs, imports, learns a model and replays a log live"
    print(f"{wheel.name} ({size:.1f} MB): {version} {done} ({seconds:.0f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))

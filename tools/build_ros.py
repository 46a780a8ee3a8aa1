# SPDX-License-Identifier: Apache-2.0
"""Builds the colcon packages of this repository against the wheels of ROS 2 in an environment, and into it.

Those below ros/, and the plug-in for Nav2, against stand-ins for what PyPI does not have: Nav2, pluginlib
and rclcpp. Beside a ROS installation none of this is needed: `colcon build` does it there. The wheels name
folders of the machine that made them, and say nothing of the linker; both are put right here. Run it by the
environment's own Python.
"""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/ros"
PACKAGES = (ROOT / "ros", ROOT / "integrations/nav2")
STAND_INS = ROOT / "python/tests/integrations/stand_in/cmake"
LIBRARY = ROOT / "build/package"  # the C++ library, built
MADE_WITH = "/opt/python/cp311-cp311"  # by which the wheels' CMake files were written


def put_right(prefix: Path) -> int:
    """Let the wheels' CMake files name this Python's folders; return how many files had to be changed."""
    import numpy as np  # the environment's

    here = {
        f"{MADE_WITH}/include/python3.11": sysconfig.get_path("include"),
        f"{MADE_WITH}/lib/python3.11/site-packages/numpy/_core/include": np.get_include(),
    }
    changed = 0
    for file in prefix.glob("share/*/cmake/*Export.cmake"):
        text = file.read_text(encoding="utf-8")
        if MADE_WITH in text:
            for before, after in here.items():
                text = text.replace(before, after)
            file.write_text(text, encoding="utf-8")
            changed += 1
    return changed


def environment(prefix: Path) -> dict[str, str]:
    """Return what colcon and CMake need to find the wheels, and programs what was built of them."""
    places = [prefix / "lib", *sorted(prefix.glob("lib/python3*/site-packages/*.libs"))]
    libraries = [*map(str, places), *filter(None, [os.environ.get("LD_LIBRARY_PATH")])]
    python = f"-L{sysconfig.get_config_var('LIBDIR')} -lpython{sysconfig.get_python_version()}"
    return os.environ | {
        "PATH": f"{prefix / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "VIRTUAL_ENV": str(prefix),  # CMake looks for Python there
        "AMENT_PREFIX_PATH": str(prefix),
        "CMAKE_PREFIX_PATH": os.pathsep.join(map(str, (prefix, STAND_INS, BUILD / "slipwise"))),
        "LD_LIBRARY_PATH": os.pathsep.join(libraries),
        "LDFLAGS": f"{os.environ.get('LDFLAGS', '')} {python}".strip(),
    }


def eigen() -> str:
    """Return the option that names the Eigen which the library was built with."""
    cache = (LIBRARY / "CMakeCache.txt").read_text(encoding="utf-8")
    return next(f"-D{line}" for line in cache.splitlines() if line.startswith("Eigen3_DIR"))


def main() -> int:
    """Build the workspace; what colcon says is shown where it fails."""
    prefix = Path(sys.prefix)
    put_right(prefix)
    BUILD.mkdir(parents=True, exist_ok=True)
    installed = ("--install", LIBRARY, "--prefix", BUILD / "slipwise")
    subprocess.run(["cmake", *installed], check=True, stdout=subprocess.DEVNULL)
    done = subprocess.run(
        [
            *(prefix / "bin/colcon", "--log-base", BUILD / "log", "build", "--base-paths", *PACKAGES),
            *("--build-base", BUILD / "build", "--merge-install", "--install-base", prefix),
            *("--event-handlers", "console_direct+", "--cmake-args", "-GNinja", "-DBUILD_TESTING=OFF"),
            *("-DCMAKE_BUILD_TYPE=Release", "--no-warn-unused-cli", eigen(), *sys.argv[1:]),
        ],
        cwd=BUILD,
        env=environment(prefix),
        check=False,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        print(done.stdout)
    else:
        built = sorted(path.parent.name for folder in PACKAGES for path in folder.glob("*/package.xml"))
        print(f"ros: {', '.join(built)} are built, and installed into {prefix.name}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())

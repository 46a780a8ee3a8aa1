# SPDX-License-Identifier: Apache-2.0
"""Where the tests of the wires find a real ROS 2."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from live.wires.peer import ROOT, Peer


def ros_python_path() -> Path:
    """Return the Python that has rclpy and pyzeros, of `SLIPWISE_ROS_VENV` or of `.venv-ros`."""
    return Path(os.environ.get("SLIPWISE_ROS_VENV", str(ROOT / ".venv-ros"))) / "bin" / "python"


@pytest.fixture(scope="session")
def ros_python() -> Path:
    """Return the Python that has rclpy; skip without it, or fail where SLIPWISE_REQUIRE_ROS=1 asks for it."""
    python = ros_python_path()
    if python.exists():
        return python
    reason = f"there is no ROS 2 for tests: {python} (`make ros-peer` installs it)"
    if os.environ.get("SLIPWISE_REQUIRE_ROS") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="module")
def robot(ros_python: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    """Start a real ROS 2 Jazzy node on Fast DDS."""
    with Peer(
        ros_python, "jazzy_node.py", environment={"ROS_LOG_DIR": str(tmp_path_factory.mktemp("ros"))}
    ) as peer:
        yield peer

# SPDX-License-Identifier: Apache-2.0
"""Where the tests of the live node find a real ROS 2."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from live.wires.peer import ROOT


@pytest.fixture(scope="session")
def ros_python() -> Path:
    """Return the Python that has rclpy and pyzeros; skip, or fail with SLIPWISE_REQUIRE_ROS=1, without.

    It is that of SLIPWISE_ROS_VENV, or of `.venv-ros`.
    """
    folder = Path(os.environ.get("SLIPWISE_ROS_VENV") or ROOT / ".venv-ros")
    if (folder / "installed.txt").exists():
        return folder / "bin" / "python"
    reason = f"there is no ROS 2 for tests in {folder} (`make ros-peer` installs it)"
    if os.environ.get("SLIPWISE_REQUIRE_ROS") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)

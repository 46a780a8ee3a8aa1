# SPDX-License-Identifier: Apache-2.0
"""A real ROS 2 node for the tests of the wires."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from live.wires.peer import Peer


@pytest.fixture(scope="module")
def robot(ros_python: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    """Start a real ROS 2 Jazzy node on Fast DDS."""
    with Peer(
        ros_python, "jazzy_node.py", environment={"ROS_LOG_DIR": str(tmp_path_factory.mktemp("ros"))}
    ) as peer:
        yield peer

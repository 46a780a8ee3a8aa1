# SPDX-License-Identifier: Apache-2.0
"""Without MuJoCo a simulation says what to install, and all else still loads."""

from __future__ import annotations

import subprocess
import sys

import pytest

from slipwise.errors import SlipwiseError
from slipwise_sim import Scenario, simulate


def test_missing_mujoco_is_named_with_the_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(SlipwiseError, match="mujoco-core"):
        simulate(Scenario(duration=1.0), seed=0)


def test_importing_the_package_does_not_load_mujoco() -> None:
    script = "import sys; from slipwise_sim import simulate; print('mujoco' in sys.modules)"
    shown = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert shown.stdout == "False\n"

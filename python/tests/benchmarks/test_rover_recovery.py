# SPDX-License-Identifier: Apache-2.0
"""A short drive of `benchmarks/rover_recovery.py`: its cases are learned, and its table is printed."""

from __future__ import annotations

import numpy as np
import pytest
import rover_recovery

pytest.importorskip("mujoco")


@pytest.mark.slow
def test_a_short_drive_is_recovered_and_printed(capsys: pytest.CaptureFixture[str]) -> None:
    case = rover_recovery.CASES[2]
    found = rover_recovery.recover(case, 1, seconds=30.0)
    assert found.value.shape == found.std.shape == found.truth.shape == (6,)
    assert np.median(found.nees) < 10.0
    rover_recovery.print_case(case, [found])
    shown = capsys.readouterr().out
    assert "| lon.V |" in shown
    assert "wheels agree to" in shown

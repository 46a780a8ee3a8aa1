# SPDX-License-Identifier: Apache-2.0
"""Commands stand in the table at 20 Hz, from standing to standing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from excitation.samples import small_drive

from slipwise.excitation import command_inputs, write_commands


def test_commands_begin_and_end_with_standing() -> None:
    drive = small_drive()
    commands = command_inputs(drive)
    assert commands.v[:20].tolist() == [0.0] * 20
    assert (commands.v[-1], commands.omega[-1]) == (0.0, 0.0)
    assert commands.t[-1] == np.float64(drive.seconds)
    np.testing.assert_allclose(np.diff(commands.t), 0.05)


def test_commands_sum_up_to_no_way_and_no_turn() -> None:
    commands = command_inputs(small_drive())
    assert abs(commands.v.sum()) < 1e-9
    assert abs(commands.omega.sum()) < 1e-9


def test_table_holds_the_commands(tmp_path: Path) -> None:
    drive = small_drive()
    text = write_commands(tmp_path / "drive.csv", drive).read_text(encoding="utf-8")
    assert text.startswith("t,cmd_v,cmd_omega\n0.000,0,0\n")
    rows = np.loadtxt(tmp_path / "drive.csv", delimiter=",", skiprows=1)
    commands = command_inputs(drive)
    np.testing.assert_allclose(rows, np.column_stack((commands.t, commands.v, commands.omega)), atol=1e-6)

# SPDX-License-Identifier: Apache-2.0
"""A drive as commands at a fixed rate, and as the table t, cmd_v, cmd_omega, or with cmd_vx and cmd_vy."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.excitation.design import LEAD, Excitation
from slipwise.excitation.moves import command_periods
from slipwise.files import write_text_whole
from slipwise.logs.log import Inputs

COMMAND_RATE = 20.0  # Hz; drives stop where a command is older than a fraction of a second


def command_inputs(drive: Excitation) -> Inputs:
    """Return the commands at 20 Hz from time zero on; the last one is to stand still."""
    step = 1.0 / COMMAND_RATE
    lead = np.zeros((round(LEAD / step), 3))
    rows = np.vstack((lead, command_periods(drive.moves, step), np.zeros((1, 3))))
    v, vy, omega = np.ascontiguousarray(rows.T)
    return Inputs(t=np.arange(len(rows), dtype=np.float64) * step, v=v, vy=vy, omega=omega)


def write_commands(path: Path, drive: Excitation) -> Path:
    """Write the commands as CSV; return its path.

    Raises:
        OutputError: the file cannot be written.
    """
    commands = command_inputs(drive)
    columns = {"cmd_v": commands.v, "cmd_omega": commands.omega}
    if drive.space.sideways > 0.0:
        columns = {"cmd_vx": commands.v, "cmd_vy": commands.vy, "cmd_omega": commands.omega}
    rows = zip(commands.t.tolist(), *(column.tolist() for column in columns.values()), strict=True)
    text = "".join(f"{t:.3f}," + ",".join(f"{value:.6g}" for value in row) + "\n" for t, *row in rows)
    write_text_whole(path, ",".join(("t", *columns)) + "\n" + text)
    return path

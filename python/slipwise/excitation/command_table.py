# SPDX-License-Identifier: Apache-2.0
"""A drive as commands at a fixed rate, and as the table t, cmd_v, cmd_omega."""

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
    lead = np.zeros((round(LEAD / step), 2))
    rows = np.vstack((lead, command_periods(drive.moves, step), np.zeros((1, 2))))
    v, omega = np.ascontiguousarray(rows.T)
    return Inputs(t=np.arange(len(rows), dtype=np.float64) * step, v=v, vy=np.zeros_like(v), omega=omega)


def write_commands(path: Path, drive: Excitation) -> Path:
    """Write the commands as CSV; return its path.

    Raises:
        OutputError: the file cannot be written.
    """
    commands = command_inputs(drive)
    rows = zip(commands.t.tolist(), commands.v.tolist(), commands.omega.tolist(), strict=True)
    text = "".join(f"{t:.3f},{v:.6g},{omega:.6g}\n" for t, v, omega in rows)
    write_text_whole(path, "t,cmd_v,cmd_omega\n" + text)
    return path

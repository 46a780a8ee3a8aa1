# SPDX-License-Identifier: Apache-2.0
"""Logs of a robot on two floors, on which it loses a tenth and half of its turns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration.calibrate_sequence import calibrate_sequence
from slipwise.calibration.learned_sequence import SequenceOptions
from slipwise.logs import Log
from slipwise.models import Model

EDD_2 = _core.named_basis("edd-2")
FIRM, LOOSE = (-0.05, -0.1), (-0.15, -0.5)


def floor_log(slip: tuple[float, float], seed: int, *, terrain: str = "", seconds: float = 60.0) -> Log:
    """Return a drive on one floor, named in its column `terrain` where that is given."""
    drive = Drive(seconds=seconds, seed=seed, basis=EDD_2, alpha=slip, name=f"drive {seed}")
    log = simulated_log(drive)
    if not terrain:
        return log
    run = log.runs[0]
    extra = {"t": run.poses.t, "terrain": np.full(len(run.poses), terrain, dtype=object)}
    return Log(runs=(replace(run, extra=extra),))


def model_of_floors(*slips: tuple[float, float], seed: int = 0, labels: tuple[str, ...] = ()) -> Model:
    """Return a model that remembers the floors it was driven on, one log each, from wheel speeds."""
    logs = [floor_log(slip, seed + k) for k, slip in enumerate(slips)]
    return calibrate_sequence(logs, input="wheel", options=SequenceOptions(labels=labels))[0].model

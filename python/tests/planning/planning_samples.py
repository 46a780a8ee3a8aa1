# SPDX-License-Identifier: Apache-2.0
"""A learned model and maps for the tests of planning."""

from __future__ import annotations

import functools

import numpy as np
from sample_logs import Drive, simulated_log
from sample_models import Made, make_model

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.models import Model
from slipwise.planning import GridMap, Limits

LIMITS = Limits(speed=1.5, yaw_rate=1.2, curvature=1.0, acceleration=0.8)
CELL = 0.1  # m


@functools.cache
def learned_model() -> Model:
    """Return a model with slip, lag and delay, learned from a simulated drive."""
    log = simulated_log(Drive(seconds=60.0, lag=0.2, delay=0.1))
    settings = make_settings({"basis": "edd-2", "auto": {"structures": ["joint"]}})
    return calibrate(log, input="command", settings=settings).model


def sliding() -> Model:
    """A model of a robot that slides downhill and turns its nose down, behind a lag and a delay."""
    values = {"lon.V": -0.05, "lon.gx": 0.05, "lat.gy": 0.1, "ang.w": -0.2, "ang.gy": 0.05}
    return make_model(Made(basis=_core.named_basis("ipem-13"), values=values, commands=True))


def walled_map() -> GridMap:
    """Return 12 m x 8 m with a wall in the middle that leaves the upper half open."""
    occupied = np.zeros((80, 120), dtype=bool)
    occupied[:45, 55:60] = True
    occupied[0] = occupied[-1] = True
    occupied[:, 0] = occupied[:, -1] = True
    return GridMap(occupied, CELL)

# SPDX-License-Identifier: Apache-2.0
"""Compares a typed model message with the model file, number by number."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipwise.models.schema import ModelFile


def assert_same_numbers(read: Any, wanted: ModelFile) -> None:
    """Fail where a number of the message is not that of the file."""
    assert (read.input, read.version, read.wheelbase) == (
        wanted.input,
        wanted.slipwise_model,
        wanted.wheelbase or 0.0,
    )
    assert [read.basis, read.lon, read.lat, read.ang] == list(wanted.slip.model_dump().values())
    rows = [
        {
            "name": row.name,
            "stage": row.stage,
            "unit": row.unit,
            "value": row.value,
            "std": row.standard_deviation,
            "prior_std": row.prior_standard_deviation,
            "identifiable": row.identifiable,
            "at": None if math.isnan(row.at) else row.at,
            "input": row.input or None,
            "sensor": row.sensor,
            "beside": row.beside,
            "branch": row.branch,
        }
        for row in read.parameters
    ]
    assert rows == [row.model_dump() for row in wanted.parameters]
    assert read.covariance.reshape(len(rows), -1).tolist() == wanted.covariance
    noise = wanted.noise.model_dump(exclude={"student_t"})
    assert {name: np.array(getattr(read.noise, name)).tolist() for name in noise} == noise
    candidates = [] if wanted.slip_disturbance is None else wanted.slip_disturbance.candidates
    assert [(each.linear, each.angular, each.time_constant, each.weight) for each in read.disturbance] == [
        tuple(each.model_dump().values()) for each in candidates
    ]
    assert read.limit_gains.tolist() == (wanted.limit_gains or [])
    assert (read.speed_range.tolist(), read.yaw_rate_range.tolist()) == (
        wanted.range.speed,
        wanted.range.yaw_rate,
    )
    for flag in ("dynamics", "delays", "response", "clock_offset", "sensor_extrinsics"):
        assert getattr(read, flag) == getattr(wanted, flag), flag

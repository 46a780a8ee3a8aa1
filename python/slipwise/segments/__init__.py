# SPDX-License-Identifier: Apache-2.0
"""Segments between measured poses, cut from the runs of a log."""

from slipwise.segments.sources import source_names, sourced_rows
from slipwise.segments.windows import (
    WindowRules,
    Windows,
    attitude_rows,
    car_prior,
    cut_windows,
    force_rows,
    input_rows,
    reading_rows,
    recording_of,
    recording_rows,
    rejections,
    wheelbase_of,
)

__all__ = [
    "WindowRules",
    "Windows",
    "attitude_rows",
    "car_prior",
    "cut_windows",
    "force_rows",
    "input_rows",
    "reading_rows",
    "recording_of",
    "recording_rows",
    "rejections",
    "source_names",
    "sourced_rows",
    "wheelbase_of",
]

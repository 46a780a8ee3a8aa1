# SPDX-License-Identifier: Apache-2.0
"""The real logs below SLIPWISE_DATA by name, and how each is evaluated."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from slipwise.logs import Log

VENDOR_MULTIPLIERS = {"husky": 1.875, "warthog": 1.125}  # the wheel-separation multipliers Clearpath ships
LONG_HORIZON = 5.0  # s
SHORT_HORIZON = 1.9  # s, where every 2 s have a frame of their own
SHORT_FOLDERS = ("warthog_windows", "drive_test")
#: Short logs of most data sets, for what has to push them many times.
FEW = (
    "f1tenth/DS4",
    "husky/wetgrass_bad_poses",
    "race_car/LVMS_23_01_04_B",
    "robotino/brown_surface",
    "tricycle/agv",
    "warthog/asphalt_9_25_12h8s57",
    "warthog/grass_7_18_16h59s20",
    "warthog_windows/asphalt_8_7_11h30s30",
)


@dataclass(frozen=True)
class DataSet:
    """One log and how to evaluate it."""

    name: str  # folder/file without suffix
    path: Path
    horizon: float  # s
    vendor_wheel_separation_multiplier: float | None


def input_names(log: Log) -> list[str]:
    """Return which inputs some run of a log has."""
    return [
        name
        for name in ("wheel", "command")
        if any((run.wheels if name == "wheel" else run.commands) is not None for run in log.runs)
    ]


def data_folder() -> Path | None:
    """Return the folder that SLIPWISE_DATA names, None where it is not set."""
    value = os.environ.get("SLIPWISE_DATA")
    return Path(value) if value else None


def required_folder() -> Path:
    """Return the folder that SLIPWISE_DATA names; where it is not set, the benchmark ends with code 2."""
    folder = data_folder()
    if folder is None:
        print("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
        raise SystemExit(2)
    return folder


def data_sets(folder: Path) -> list[DataSet]:
    """Return all logs of the folder by name."""
    return [
        _data_set(path.relative_to(folder).as_posix().removesuffix(".csv.gz"), path)
        for path in sorted(folder.rglob("*.csv.gz"))
    ]


def _data_set(name: str, path: Path) -> DataSet:
    vendor = [multiplier for robot, multiplier in VENDOR_MULTIPLIERS.items() if robot in name]
    horizon = SHORT_HORIZON if name.startswith(SHORT_FOLDERS) else LONG_HORIZON
    return DataSet(name, path, horizon, vendor[0] if vendor else None)

# SPDX-License-Identifier: Apache-2.0
"""A drive written down in every way that a tidy log has: one table for each kind of measurement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.logs import LogOptions

DRIVE = Drive(
    seconds=15.0,
    seed=5,
    basis=_core.named_basis("full-linear-6"),
    alpha=(-0.05, 0.0, 0.0, 0.1, 0.0, -0.2),
    lag=0.2,
    delay=0.1,
)
_ROLLERS = """vehicle:
  wheels:
    - {name: fl, x: 0.2, y: 0.15, radius: 0.1, roller: -0.785398}
    - {name: fr, x: 0.2, y: -0.15, radius: 0.1, roller: 0.785398}
    - {name: rl, x: -0.2, y: 0.15, radius: 0.1, roller: 0.785398}
    - {name: rr, x: -0.2, y: -0.15, radius: 0.1, roller: -0.785398}
"""
_STEERED = """vehicle:
  wheels:
    - {name: f, x: 0.3, y: 0.0, radius: 0.1, steer: front, pivot: [0.28, 0.0]}
    - {name: r, x: -0.3, y: 0.0, radius: 0.1, steer: rear}
"""

Column = NDArray[Any]


@dataclass(frozen=True)
class Kind:
    """A table, and how it is read."""

    columns: Mapping[str, Column]
    options: Mapping[str, Any] = field(default_factory=dict)
    input: str = "wheel"
    vehicle: str = ""  # description of it, for a file

    def text(self) -> str:
        """The table as CSV."""
        rows = zip(*(map(_cell, values.tolist()) for values in self.columns.values()), strict=True)
        return "\n".join([",".join(self.columns), *map(",".join, rows)]) + "\n"

    def read(self, folder: Path) -> tuple[Path, LogOptions]:
        """Write the table into a folder; return its file and the options."""
        path, options = folder / "drive.csv", dict(self.options)
        path.write_text(self.text())
        if self.vehicle:
            options["vehicle"] = str(folder / "robot.yaml")
            (folder / "robot.yaml").write_text(self.vehicle)
        return path, LogOptions.of(options)


def _cell(value: object) -> str:
    return "" if value is None or value != value else repr(value) if isinstance(value, float) else str(value)


def kinds() -> dict[str, Kind]:
    """Every kind of measurement, by name."""
    run = simulated_run(DRIVE)
    assert run.commands is not None
    assert run.wheels is not None
    c, w, p = run.commands, run.wheels, run.poses
    t, n = c.t, len(c)
    commands = {"t": t, "cmd_v": c.v, "cmd_omega": c.omega}
    wheels = {"t": t, "odo_v": w.v, "odo_omega": w.omega}
    place, pose = {"x": p.x, "y": p.y}, {"x": p.x, "y": p.y, "yaw": p.yaw}
    gyro = {"gyro_z": np.gradient(np.unwrap(p.yaw), t)}
    turn = np.divide(c.omega, c.v, out=np.zeros(n), where=np.abs(c.v) > 0.2)
    aside = 0.3 * np.sin(t)
    seldom = np.arange(n) % 4 == 0
    held = {name: values[np.arange(n) // 4 * 4] for name, values in pose.items()}
    words = _words(n)
    return {
        "commands and wheels": Kind(commands | wheels | pose, input="command"),
        "commands alone": Kind(commands | pose, input="command"),
        "empty cells": Kind(wheels | {name: np.where(seldom, v, np.nan) for name, v in pose.items()}),
        "held poses": Kind(wheels | held),
        "poses said to be new": Kind(wheels | held | {"pose_new": seldom.astype(int)}),
        "positions": Kind(wheels | place),
        "positions and a gyro": Kind(wheels | place | gyro),
        "a gyro alone": Kind(wheels | gyro),
        "curvature": Kind({"t": t, "cmd_v": c.v, "cmd_curvature": turn} | pose, input="command"),
        "steering": Kind(
            {"t": t, "cmd_v": c.v, "cmd_steer": np.arctan(0.4 * turn)} | pose, {"wheelbase": 0.4}, "command"
        ),
        "sideways": Kind(
            {"t": t, "cmd_vx": c.v, "cmd_vy": aside, "cmd_omega": c.omega} | pose, input="command"
        ),
        "throttle and steering": Kind(
            {"t": t, "throttle": c.v / 3.0, "steering": c.omega / 2.0} | pose, {"vehicle": "dart"}, "command"
        ),
        "left and right": Kind(
            {"t": t, "wheel_left": (w.v - 0.25 * w.omega) / 0.1, "wheel_right": (w.v + 0.25 * w.omega) / 0.1}
            | pose,
            {"wheel_radius": 0.1, "wheel_separation": 0.5},
        ),
        "rollers": Kind({"t": t} | _rolled(w.v, aside, w.omega) | pose, vehicle=_ROLLERS),
        "steered wheels": Kind({"t": t} | _steered(w.v, w.omega) | pose, vehicle=_STEERED),
        "roll and pitch": Kind(wheels | pose | {"roll": 0.05 * np.sin(t), "pitch": 0.04 * np.cos(t)}),
        "known force": Kind(wheels | pose | {"force_y": np.where(t // 7.0 % 2.0 == 0.0, 0.8, -0.8)}),
        "deviations and frames": Kind(
            wheels | pose | {"std_xy": 0.01 + 0.005 * np.sin(t), "frame": words(("map", "odom"), 150)}
        ),
        "two sources": Kind(wheels | pose | {"source": words(("lidar", "mocap"), 1)}),
        "two sources, turned and late": Kind(
            wheels | pose | {"source": words(("lidar", "mocap"), 1)},
            {"pose_yaw_offset": 0.3, "pose_clock_offset": -0.04},
        ),
        "steering beside a scaled speed": Kind(
            {"t": t, "cmd_v": 3.6 * c.v, "cmd_steer": np.arctan(0.4 * turn)} | pose,
            {"wheelbase": 0.4, "command_scale": [1.0 / 3.6, 1.0]},
            "command",
        ),
        "fixes": Kind(wheels | place | {"fix": words(("rtk_fixed", "rtk_float"), 60)}),
        "runs": Kind(wheels | pose | {"run": words(("one", "two"), n // 2)}),
        "labels": Kind(wheels | pose | {"terrain": words(("grass", "sand"), 200)}),
        "other names": Kind(
            {"time": t, "v": w.v, "w": w.omega} | pose,
            {
                "columns": {"t": "time", "odo_v": "v", "odo_omega": "w"},
                "wheel_scale": [0.9, 1.1],
                "pose_yaw_offset": 0.3,
            },
        ),
    }


def _words(count: int) -> Any:
    def words(names: Sequence[str], rows: int) -> Column:
        """Names that take turns, each for some rows."""
        return np.array(names)[np.arange(count) // rows % len(names)]

    return words


def _rolled(v: Column, vy: Column, omega: Column) -> dict[str, Column]:
    signs = {"fl": (-1, -1), "fr": (1, 1), "rl": (1, -1), "rr": (-1, 1)}
    return {f"wheel_{name}": (v + a * vy + b * 0.35 * omega) / 0.1 for name, (a, b) in signs.items()}


def _steered(v: Column, omega: Column) -> dict[str, Column]:
    found = {}
    for name, joint, x in (("f", "front", 0.3), ("r", "rear", -0.3)):
        found[f"wheel_{name}"] = np.hypot(v, x * omega) / 0.1 * np.where(v < 0.0, -1.0, 1.0)
        found[f"steer_{joint}"] = np.arctan(
            np.divide(x * omega, v, out=np.zeros(len(v)), where=np.abs(v) > 0.05)
        )
    return found

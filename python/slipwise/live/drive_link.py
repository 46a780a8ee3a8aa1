# SPDX-License-Identifier: Apache-2.0
"""What carries commands to a robot that drives by itself, and brings poses and the dead man's button."""

from __future__ import annotations

from typing import Protocol

from slipwise.live.drive_guard import DriveGuard


class DriveLink(Protocol):
    """Commands go from one thread; what is heard may come from any."""

    log: DriveLog

    def hear(self, guard: DriveGuard) -> None:
        """Hand poses and the dead man's button to a guard from now on."""

    def missing(self) -> str:
        """Return what is not connected yet; empty where all is.

        Raises:
            SettingsError: something is there that does not fit.
        """

    def send(self, v: float, omega: float) -> None:
        """Command a speed [m/s] and a yaw rate [rad/s]; never waits."""

    def close(self) -> None:
        """Leave; may be called twice."""


class DriveLog:
    """Commands and poses of the drive with their stamps, as a log to learn from."""

    def __init__(self) -> None:
        self._commands: list[tuple[float, float, float]] = []
        self._poses: list[tuple[float, float, float, float]] = []

    @property
    def commands(self) -> int:
        """How many there were."""
        return len(self._commands)

    def take_command(self, t: float, v: float, omega: float) -> None:
        """Take a command at a stamp [s]."""
        self._commands.append((t, v, omega))

    def take_pose(self, t: float, x: float, y: float, yaw: float) -> None:
        """Take a pose at a stamp [s]."""
        self._poses.append((t, x, y, yaw))

    def text(self) -> str:
        """Return all as a tidy table, by stamp."""
        rows = [(t, f"{t:.6f},{v:.6g},{omega:.6g},,,") for t, v, omega in list(self._commands)]
        rows += [(t, f"{t:.6f},,,{x:.6f},{y:.6f},{yaw:.6f}") for t, x, y, yaw in list(self._poses)]
        rows.sort(key=lambda row: row[0])
        return "\n".join(["t,cmd_v,cmd_omega,x,y,yaw", *(row for _, row in rows), ""])

# SPDX-License-Identifier: Apache-2.0
"""A robot without ROS that is driven: JSON lines in and out, on a pipe or as UDP packets."""

from __future__ import annotations

import contextlib
import json
import threading
import time
from collections.abc import Callable
from typing import IO

from slipwise.errors import LogError, SettingsError
from slipwise.live.drive_guard import DriveGuard
from slipwise.live.drive_link import DriveLog
from slipwise.live.lines import LineReader
from slipwise.live.samples import Pose
from slipwise.live.udp import DEFAULT_ADDRESS, LARGEST, listening_socket

SILENT = 2.0  # s without packets, after which another program may be the robot


class LineDriveLink:
    """Hears lines such as {"t": 12.1, "x": 1, "y": 2, "yaw": 0.3, "dead_man": true}; either may be alone.

    Commands are lines such as {"t": 12.2, "cmd_v": 0.5, "cmd_omega": 0.1}. A line that cannot be read counts
    as none, so that the robot stops where no others come.

    Args:
        write: sends one line; it may raise OSError.
    """

    def __init__(self, write: Callable[[str], None]) -> None:
        self._write, self._reader = write, LineReader()
        self._guard: DriveGuard | None = None
        self._ahead = 0.0  # s, the stamps of poses minus the clock
        self._came = False
        self.log = DriveLog()

    def hear(self, guard: DriveGuard) -> None:
        """Hand poses and the dead man's button to a guard from now on."""
        self._guard = guard

    def missing(self) -> str:
        """Return what is not connected yet."""
        return "" if self._came else "lines from the robot"

    def take(self, line: str) -> None:
        """Take a line."""
        self._came = True
        if self._guard is None:
            return
        pressed = _dead_man(line)
        if pressed is not None:
            self._guard.take_dead_man(pressed)
        with contextlib.suppress(LogError):
            for sample in self._reader.read(line):
                if isinstance(sample, Pose):
                    self._ahead = sample.t - time.time()
                    self._guard.take_pose(sample)
                    self.log.take_pose(sample.t, sample.x, sample.y, sample.yaw)

    def send(self, v: float, omega: float) -> None:
        """Command a speed [m/s] and a yaw rate [rad/s].

        Raises:
            OSError: nobody takes it.
        """
        t = time.time() + self._ahead
        self._write(json.dumps({"t": round(t, 6), "cmd_v": v, "cmd_omega": omega}))
        self.log.take_command(t, v, omega)

    def close(self) -> None:
        """There is nothing to close."""


def _dead_man(line: str) -> bool | None:
    """Return whether the button is pressed; anything but true is not; None: the line does not say."""
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not isinstance(content, dict) or "dead_man" not in content:
        return None
    return content["dead_man"] is True


class PipeDriveLink(LineDriveLink):
    """Reads one stream and writes to another; where the first ends, nothing is heard any more."""

    def __init__(self, lines: IO[str], results: IO[str]) -> None:
        super().__init__(self._print)
        self._lines, self._results = lines, results
        self._ended = threading.Event()

    def hear(self, guard: DriveGuard) -> None:
        """Hand poses and the dead man's button to a guard; what was not read before is heard, too."""
        super().hear(guard)
        threading.Thread(target=self._read, name="lines", daemon=True).start()

    def missing(self) -> str:
        """Return what is not connected yet.

        Raises:
            SettingsError: the stream has ended, so that nothing more will come.
        """
        if self._ended.is_set():
            raise SettingsError("standard input has ended before the drive", where="--transport stdin")
        return super().missing()

    def _print(self, line: str) -> None:
        self._results.write(line + "\n")
        self._results.flush()

    def _read(self) -> None:
        with contextlib.suppress(ValueError, OSError):  # closed under way
            for line in self._lines:
                self.take(line)
        self._ended.set()


class UdpDriveLink(LineDriveLink):
    """Hears packets of one program, and sends commands to it.

    Raises:
        SettingsError: the address cannot be used.
    """

    def __init__(self, address: str = DEFAULT_ADDRESS) -> None:
        super().__init__(self._send_packet)
        self._socket = listening_socket(address)
        self._sender: tuple[str, int] | None = None
        self._heard_at = 0.0  # s
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="udp", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    def close(self) -> None:
        """Stop listening."""
        self._stopped.set()
        self._thread.join(timeout=2.0)
        self._socket.close()

    def _send_packet(self, line: str) -> None:
        if self._sender is not None:
            self._socket.sendto(line.encode() + b"\n", self._sender)

    def _listen(self) -> None:
        while not self._stopped.is_set():
            try:
                packet, sender = self._socket.recvfrom(LARGEST + 1)
            except TimeoutError:
                continue
            except OSError:
                return
            now = time.monotonic()
            if sender != self._sender and self._sender is not None and now < self._heard_at + SILENT:
                continue  # one robot is driven: another program does not take its commands over
            self._sender, self._heard_at = sender, now
            for line in packet.decode("utf-8", errors="replace").splitlines():
                self.take(line)

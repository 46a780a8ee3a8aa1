# SPDX-License-Identifier: Apache-2.0
"""Reads PX4's logs (.ulg) with pyulog."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.extras import to_install
from slipwise.logs.flight_roles import FlightMessages

#: The topics that say anything about a rover's motion; those of several versions of PX4.
TOPICS = (
    "rover_differential_setpoint",
    "rover_rate_setpoint",
    "rover_speed_setpoint",
    "rover_velocity_setpoint",
    "vehicle_attitude",
    "vehicle_local_position",
    "wheel_encoders",
)


MOST_RETURNS = 10_000  # to places that were passed before


def read_ulog(path: Path) -> FlightMessages:
    """Read a ULog; where a topic has several instances, the first.

    Raises:
        LogError: it is damaged, or pyulog is not installed.
    """
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            from pyulog import ULog

            with _Forward(io.FileIO(path)) as file:
                log = ULog(file, message_name_filter_list=list(TOPICS))
            topics = {item.name: _columns(item) for item in log.data_list if item.multi_id == 0}
            parameters = {str(name): float(value) for name, value in log.initial_parameters.items()}
    except ImportError as error:
        raise LogError("pyulog is not installed", where=str(path), advice=to_install("px4")) from error
    except Exception as error:  # damaged bytes make the library raise anything
        reason = f"{type(error).__name__} {error}"[:200]
        raise LogError(
            f"not a readable ULog: {reason}", where=str(path), advice="copy it again from the vehicle"
        ) from error
    return FlightMessages("ulog", {name: each for name, each in topics.items() if len(each["t"])}, parameters)


class _Forward(io.BufferedReader):
    """A file that allows no endless seek back, as pyulog does from the end of some damaged ones."""

    _farthest, _returns = -1, 0

    def seek(self, offset: int, whence: int = 0, /) -> int:
        """Go to a place as in any file.

        Raises:
            EOFError: the place was behind another one too often; pyulog takes many other errors for damage.
        """
        place = super().seek(offset, whence)
        self._returns += place <= self._farthest
        self._farthest = max(self._farthest, place)
        if self._returns > MOST_RETURNS:
            raise EOFError("the end of the file is damaged")
        return place


def _columns(item: Any) -> dict[str, Any]:
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in item.data.items()}
    return columns | {"t": columns["timestamp"] * 1e-6}

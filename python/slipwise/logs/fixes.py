# SPDX-License-Identifier: Apache-2.0
"""What a satellite receiver says of a position: fixes by name or by the number of a GGA sentence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError
from slipwise.logs.log import Floats

FIXES: tuple[str, ...] = tuple(_core.fix_names())  # by code; the first is unknown
CODES = {name: code for code, name in enumerate(FIXES) if name}
NO_FIX = CODES["none"]

# NMEA 0183, 4.10: quality of a GGA sentence; of 3 (PPS) and 7, 8 (entered, simulated) nothing is said here
_OF_GGA = {
    "0": "none",
    "1": "single",
    "2": "differential",
    "4": "rtk_fixed",
    "5": "rtk_float",
    "6": "estimated",
}
# sensor_msgs/NavSatStatus; receivers say of a base station's corrections that they are ground based
_OF_STATUS = {-1: "none", 0: "single", 1: "differential", 2: "rtk_fixed"}
_ALSO = {
    "no_fix": "none",
    "dgps": "differential",
    "gps": "single",
    "fixed": "rtk_fixed",
    "float": "rtk_float",
}


def fix_codes(words: Sequence[str], where: str = "") -> Floats:
    """Return codes of fixes, [N]; NaN where a word is empty.

    Args:
        words: names such as rtk_fixed, or numbers as a GGA sentence has them, [N].
        where: the file.

    Raises:
        LogError: a word is neither.
    """
    known: dict[str, float] = {"": np.nan}
    for word in set(words) - {""}:
        name = word.strip().lower().replace("-", "_").replace(" ", "_").removesuffix(".0")
        name = _OF_GGA.get(name, _ALSO.get(name, name))
        if name not in CODES and name not in ("3", "7", "8", ""):
            raise LogError(
                f"unknown fix '{word}'",
                where=where,
                advice=f"known are {', '.join(CODES)}, and the numbers of a GGA sentence",
            )
        known[word] = CODES.get(name, np.nan)
    return np.array([known[word] for word in words], dtype=np.float64)


def fix_of_status(status: float) -> str:
    """Return the name of a NavSatStatus; an empty string if it is unknown."""
    return _OF_STATUS.get(int(status), "") if np.isfinite(status) else ""


def status_codes(status: Floats) -> Floats:
    """Return codes of fixes of a NavSatStatus, [N]."""
    return np.array(
        [CODES.get(fix_of_status(each), np.nan) for each in status],
        dtype=np.float64,
    )


def fix_words(codes: Floats) -> NDArray[np.object_]:
    """Return the names of fixes, [N]; empty if nothing is known."""
    return np.array([FIXES[int(code)] or None for code in np.nan_to_num(codes)], dtype=object)


def fix_number(name: str) -> int:
    """Return the code of a fix, 0 where nothing is said.

    Raises:
        LogError: there is no such fix.
    """
    return 0 if not name else int(np.nan_to_num(fix_codes([name])[0]))

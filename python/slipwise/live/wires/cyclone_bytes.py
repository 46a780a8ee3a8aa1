# SPDX-License-Identifier: Apache-2.0
"""Reads and writes messages of Cyclone DDS as the bytes that they are on the wire."""

from __future__ import annotations

from typing import Any

_ANY = 0xFFFF  # samples, views and instances of all states
_AT_ONCE = 256


def take_cdr(reader: Any) -> list[bytes]:
    """Return the messages that a reader has and forget them there, oldest first, 256 at most.

    Raises:
        OSError: Cyclone refuses.
    """
    from cyclonedds._clayer import ddspy_take

    taken = ddspy_take(reader._ref, _ANY, _AT_ONCE)  # noqa: SLF001
    if isinstance(taken, int):
        raise OSError(f"Cyclone DDS does not read: code {taken}")
    return [message for message, info in taken if info.valid_data]


def write_cdr(writer: Any, message: bytes) -> None:
    """Send a message, padded to whole words as Cyclone wants it.

    Raises:
        OSError: Cyclone refuses it.
    """
    from cyclonedds._clayer import ddspy_write

    result = ddspy_write(writer._ref, message + b"\0" * (-len(message) % 4))  # noqa: SLF001
    if result < 0:
        raise OSError(f"Cyclone DDS does not write a message of {len(message)} bytes: code {result}")

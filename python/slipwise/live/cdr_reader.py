# SPDX-License-Identifier: Apache-2.0
"""Messages of the usual types, of which only what is taken out of them is read, at its place in the bytes."""

from __future__ import annotations

import struct
from collections.abc import Callable
from types import SimpleNamespace as Part
from typing import TYPE_CHECKING, Any

from slipwise.logs.messages import ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE, TWIST, TWIST_STAMPED

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

ReadMessage = Callable[[bytes], Any]

_BEFORE = 4  # bytes of CDR's own header; alignment counts from there
_LITTLE_ENDIAN = b"\x00\x01"
_HEADER = struct.Struct("<iII")  # s, ns, and the length of the frame's name with its zero
_LENGTH = struct.Struct("<I")
_TWIST = struct.Struct("<6d")
_POSE = struct.Struct("<7d")
_UNCERTAIN_POSE = struct.Struct("<8d48xd216xd")  # with the covariance's elements 0, 7 and 35 of 36
_ODOMETRY = struct.Struct("<8d48xd216xd6d288x")  # the same, a twist, and its covariance


def reader_of(kind: str, store: Typestore) -> ReadMessage:
    """Return what reads messages of type `kind`; it raises where the bytes are no such message.

    What it returns has the attributes that `slipwise.logs.messages` takes numbers from, and the header. Full
    decoding takes ten times as long. Types that are not among the usual ones, and the other order of bytes,
    are decoded in full.
    """
    read = _READERS.get(kind)

    def in_full(payload: bytes) -> Any:
        return store.deserialize_cdr(payload, kind)

    if read is None:
        return in_full
    return lambda payload: read(payload) if payload[:2] == _LITTLE_ENDIAN else in_full(payload)


def _header(payload: bytes) -> tuple[Part, int]:
    """Return a header and where it ends."""
    sec, nanosec, length = _HEADER.unpack_from(payload, _BEFORE)
    begin = _BEFORE + _HEADER.size
    end = begin + length
    return Part(stamp=Part(sec=sec, nanosec=nanosec), frame_id=payload[begin : end - 1].decode()), end


def _aligned(place: int) -> int:
    """Return where the next number of 8 bytes begins."""
    return _BEFORE + ((place - _BEFORE + 7) & ~7)


def _twist_of(numbers: tuple[float, ...]) -> Part:
    x, y, z, roll, pitch, yaw = numbers
    return Part(linear=Part(x=x, y=y, z=z), angular=Part(x=roll, y=pitch, z=yaw))


def _pose_of(numbers: tuple[float, ...]) -> Part:
    x, y, z, qx, qy, qz, qw = numbers
    return Part(position=Part(x=x, y=y, z=z), orientation=Part(x=qx, y=qy, z=qz, w=qw))


def _uncertain(numbers: tuple[float, ...]) -> Part:
    return Part(pose=_pose_of(numbers[:7]), covariance={0: numbers[7], 7: numbers[8], 35: numbers[9]})


def _read_twist(payload: bytes) -> Part:
    return _twist_of(_TWIST.unpack_from(payload, _BEFORE))


def _read_twist_stamped(payload: bytes) -> Part:
    header, end = _header(payload)
    return Part(header=header, twist=_twist_of(_TWIST.unpack_from(payload, _aligned(end))))


def _read_pose_stamped(payload: bytes) -> Part:
    header, end = _header(payload)
    return Part(header=header, pose=_pose_of(_POSE.unpack_from(payload, _aligned(end))))


def _read_uncertain_pose(payload: bytes) -> Part:
    header, end = _header(payload)
    return Part(header=header, pose=_uncertain(_UNCERTAIN_POSE.unpack_from(payload, _aligned(end))))


def _read_odometry(payload: bytes) -> Part:
    header, end = _header(payload)
    begin = _BEFORE + ((end - _BEFORE + 3) & ~3)  # of the child frame's name
    (length,) = _LENGTH.unpack_from(payload, begin)
    numbers = _ODOMETRY.unpack_from(payload, _aligned(begin + _LENGTH.size + length))
    return Part(header=header, pose=_uncertain(numbers[:10]), twist=Part(twist=_twist_of(numbers[10:])))


_READERS: dict[str, Callable[[bytes], Part]] = {
    TWIST: _read_twist,
    TWIST_STAMPED: _read_twist_stamped,
    POSE_STAMPED: _read_pose_stamped,
    POSE_WITH_COVARIANCE: _read_uncertain_pose,
    ODOMETRY: _read_odometry,
}

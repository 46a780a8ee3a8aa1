# SPDX-License-Identifier: Apache-2.0
"""Changes of files that find faults of readers: bytes, numbers, pieces, lengths."""

from __future__ import annotations

import random
import re
import struct

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_NUMBERS = (
    *(b"0", b"-1", b"1e300", b"-1e300", b"1e-300", b"nan", b"inf", b"-inf", b"", b"1e6", b"9" * 400),
    *(b"9223372036854775808", b"-9223372036854775808", b"4294967296", b"2147483647", b"0x7fffffff", b"true"),
)
_SMALL = re.compile(rb"[^\0][\0-\x0f]\0{6}", re.DOTALL)
_PIECES = (
    *(b"\0", b"\r", b"\n", b"\xff\xfe", b'"', b"'", b",", b";", b": "),
    *(b"[", b"]", b"{", b"&a ", b"*a", b"!!x "),
)
_INTEGERS = (
    *(0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF),
    *(1 << 62, (1 << 63) - 1, 1 << 63, (1 << 64) - 1),
)


def mutated(seed: bytes, draw: random.Random, others: list[bytes]) -> bytes:
    """Return the file with one to a few changes."""
    data = bytearray(seed)
    for _ in range(draw.choice((1, 1, 1, 2, 4, 16))):
        draw.choice(_CHANGES)(data, draw, others)
    return bytes(data)


def _flip(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if data:
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)


def _byte(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if data:
        data[draw.randrange(len(data))] = draw.randrange(256)


def _integer(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    size = draw.choice((1, 2, 4, 8))
    if len(data) > size:
        at = draw.randrange(len(data) - size)
        value = draw.choice(_INTEGERS) & ((1 << (8 * size)) - 1)
        data[at : at + size] = value.to_bytes(size, draw.choice(("little", "big")))


def _count(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    """Change what may be a count or a place of eight bytes, little-endian: the next small number."""
    start = draw.randrange(len(data) + 1)
    for match in _SMALL.finditer(data, start):
        value = int.from_bytes(match[0], "little")
        value = draw.choice((value + 1, max(value - 1, 0), 0, 255, *_INTEGERS)) & ((1 << 64) - 1)
        data[match.start() : match.end()] = value.to_bytes(8, "little")
        return


def _double(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if len(data) > 8:
        at = draw.randrange(len(data) - 8)
        value = draw.choice((float("nan"), float("inf"), 1e300, -1e15, 1e6, 1e-300, 0.0))
        data[at : at + 8] = struct.pack("<d", value)


def _number(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    found = list(_NUMBER.finditer(data))
    if found:
        place = draw.choice(found)
        data[place.start() : place.end()] = draw.choice(_NUMBERS)


def _remove(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if data:
        at = draw.randrange(len(data))
        del data[at : at + draw.choice((1, 2, 8, 64, 4096))]


def _cut(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if data:
        del data[draw.randrange(len(data)) :]


def _insert(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    at = draw.randrange(len(data) + 1)
    data[at:at] = draw.choice(_PIECES) * draw.choice((1, 1, 1, 50))


def _repeat(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    if data:
        at, size = draw.randrange(len(data)), draw.choice((1, 8, 64, 1024))
        data[at:at] = data[at : at + size]


def _splice(data: bytearray, draw: random.Random, others: list[bytes]) -> None:
    other = draw.choice(others)
    if data and other:
        at, size = draw.randrange(len(data)), draw.choice((4, 32, 256, 4096))
        start = draw.randrange(len(other))
        data[at : at + size] = other[start : start + size]


def _line(data: bytearray, draw: random.Random, _: list[bytes]) -> None:
    lines = bytes(data).split(b"\n")
    if len(lines) > 2:
        i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
        lines[i], lines[j] = lines[j], lines[i]
        data[:] = b"\n".join(lines)


_CHANGES = (
    *(_flip, _byte, _byte, _integer, _integer, _count, _double, _number, _number),
    *(_remove, _cut, _insert, _repeat, _splice, _line),
)

# SPDX-License-Identifier: Apache-2.0
"""Addresses of files on servers (https, s3, gs, az), what of them may be shown, and places to listen at."""

from __future__ import annotations

import re
from pathlib import Path

_REMOTE = re.compile(r"(?P<scheme>https?|s3|gs|az):/{1,2}(?P<rest>[^/].*)", re.DOTALL)
_ADDRESS = re.compile(r"(?:https?|s3|gs|az):/{1,2}[^/\s'\"][^\s'\"]*")


def remote_url(path: str | Path) -> str | None:
    """Return the address that a path is; None where it names a file on this machine.

    A `Path` makes one slash of two; the two after the scheme are put back.
    """
    match = _REMOTE.fullmatch(str(path))
    return f"{match['scheme']}://{match['rest']}" if match else None


def shown(path: str | Path) -> str:
    """Return a path as it may be shown: an address without user, password and signature."""
    url = remote_url(path)
    return str(path) if url is None else _public(url)


def masked(text: str) -> str:
    """Return a text without what the addresses in it keep secret."""
    return _ADDRESS.sub(lambda match: shown(match[0]), text)


def _public(url: str) -> str:
    scheme, _, rest = url.partition("://")
    place = re.split(r"[?#]", rest, maxsplit=1)[0]
    server, slash, path = place.partition("/")
    return f"{scheme}://{server.rpartition('@')[2]}{slash}{path}"


def host_and_port(address: str) -> tuple[str, str]:
    """Return the host of an address and its port, "" where it has none; "[::1]:7447" is "::1" and "7447"."""
    host, colon, port = address.rpartition(":")
    ported = colon and port.isdigit() and (":" not in host or host.endswith("]"))
    return (host.strip("[]"), port) if ported else (address, "")

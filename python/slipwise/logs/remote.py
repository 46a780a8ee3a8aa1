# SPDX-License-Identifier: Apache-2.0
"""Logs on servers (https, s3, gs, az): copied into a temporary file, up to a size and no further."""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from slipwise.addresses import remote_url, shown
from slipwise.errors import LogError
from slipwise.extras import to_install
from slipwise.logs.piped import regular_file

if TYPE_CHECKING:
    from fsspec import AbstractFileSystem

MOST_FETCHED = 4096.0  # [MiB]: hours of a robot; a larger file is a camera's, and is better copied once
_BLOCK = 1 << 20
_NOT_FOUND = 404  # of HTTP
_PATIENCE = 60.0  # [s] without a byte
_SLOWEST = 16384.0  # [bytes/s] on the average, after as long: a file takes no longer than its size asks for
_AGAIN = "try again, or copy the file yourself"
_TAGS = ("ETag", "etag", "md5Hash", "Content-MD5", "generation", "Last-Modified", "LastModified", "updated")
_CHANGED = (
    "Last-Modified",
    "LastModified",
    "last_modified",
    "updated",
    "mtime",
)  # of HTTP, S3, Azure, Google
_PACKAGES = {"s3": "s3fs", "gs": "gcsfs", "az": "adlfs"}


def staged(url: str, most: float | None = None) -> Path:
    """Return a copy on this machine, which is removed when the program ends; each address is fetched once.

    Args:
        url: the address, of a scheme that `remote_url` knows.
        most: MiB that the file may have; default MOST_FETCHED.

    Raises:
        LogError: a package is missing, the file cannot be fetched, is too large or comes cut off.
    """
    asked = _asked(url, most)
    if asked not in _copies:
        _copies[asked] = _fetched(*asked)
    return _copies[asked][1]


def _asked(url: str, most: float | None = None) -> tuple[str, int]:
    """Return the address, and how many bytes the file may have."""
    return url, int((MOST_FETCHED if most is None else most) * 1024 * 1024)


@contextlib.contextmanager
def lent(url: str) -> Iterator[Path]:
    """Lend a copy on this machine, which `open_log` reads for this address, and remove it at the end.

    Raises:
        LogError: as `staged` does.
    """
    asked = _asked(url)
    try:
        yield staged(url)
    finally:
        if asked in _copies:
            _copies.pop(asked)[0].cleanup()


@dataclass(frozen=True)
class RemoteVersion:
    """What a server says of a file without sending it."""

    tag: str  # another one where the file changed; empty where the server says nothing of it
    changed: float | None  # s since 1970


def remote_version(url: str) -> RemoteVersion:
    """Return what tells one version of a file on a server from the next.

    Raises:
        LogError: a package is missing, there is no such file, or the server does not answer.
    """
    where = shown(url)
    system = _file_system(url.partition(":")[0], where, total=_PATIENCE)
    try:
        about = system.info(url)
    except Exception as error:  # the clients of servers have errors of their own
        raise _failure(error, url, where) from error
    said = [f"{name}={about[name]}" for name in _TAGS if about.get(name)]
    return RemoteVersion(" ".join([*said, f"size={about.get('size')}"]) if said else "", _changed(about))


def _changed(about: Mapping[str, Any]) -> float | None:
    """Return when a file was changed [s since 1970], which every kind of server says in its own way."""
    said = next((about[name] for name in _CHANGED if about.get(name)), None)
    with contextlib.suppress(ValueError, OverflowError):
        if isinstance(said, str):
            iso = said[:1].isdigit()
            said = datetime.fromisoformat(said) if iso else parsedate_to_datetime(said)
        if isinstance(said, datetime):
            return (said if said.tzinfo else said.replace(tzinfo=UTC)).timestamp()
    return None


def local_file(path: Path, advice: str, most: float | None = None) -> Path:
    """Return the file to read: itself, or a copy of what comes through a pipe or from a server.

    Args:
        path: a file, a folder, a pipe or an address.
        advice: what to do where there is none.
        most: MiB that a file on a server may have; default MOST_FETCHED.

    Raises:
        LogError: there is no such file, it cannot be fetched, or is no regular file.
    """
    url = remote_url(path)
    if "\0" not in str(path) and path.exists():
        return regular_file(path)
    if url is None:
        raise LogError("no such file", where=str(path), advice=advice)
    return staged(url, most)


_Folder = tempfile.TemporaryDirectory[str]
_copies: dict[
    tuple[str, int], tuple[_Folder, Path]
] = {}  # by address and limit; removed when the program ends


def _fetched(url: str, most: int) -> tuple[_Folder, Path]:
    where = shown(url)
    scheme = url.partition(":")[0]
    asking = _file_system(scheme, where, total=_PATIENCE)
    folder = tempfile.TemporaryDirectory(prefix="slipwise-")
    copy = Path(folder.name) / _name(where)
    try:
        size = _known_size(asking, url, where, most)
        system = _file_system(scheme, where, total=_PATIENCE + (most if size is None else size) / _SLOWEST)
        copied = _copy(system, url, copy, most)
        if size not in (None, copied):
            raise LogError(f"cut off: {copied} of {size} bytes came", where=where, advice=_AGAIN)
    except LogError:
        folder.cleanup()
        raise
    except Exception as error:  # the clients of servers have errors of their own
        folder.cleanup()
        raise _failure(error, url, where) from error
    return folder, copy


def _file_system(scheme: str, where: str, *, total: float) -> AbstractFileSystem:
    """Return what speaks with a server, each of whose answers is there within `total` seconds."""
    try:
        import fsspec

        options: dict[str, Any] = {"skip_instance_cache": True}
        if scheme in ("http", "https"):
            import aiohttp

            patience = aiohttp.ClientTimeout(total=total, sock_connect=_PATIENCE, sock_read=_PATIENCE)
            options["client_kwargs"] = {"trust_env": True, "timeout": patience}
        return fsspec.filesystem(scheme, **options)
    except ImportError as error:
        other = _PACKAGES.get(scheme)
        advice = to_install("remote") + (f" {other}" if other else "") + ", or copy the file yourself"
        raise LogError(f"reading {scheme}:// needs another package", where=where, advice=advice) from error


def _known_size(system: AbstractFileSystem, url: str, where: str, most: int) -> int | None:
    """Return the bytes that the server says the file has, None where it does not say.

    Raises:
        LogError: it is a folder, more than is allowed, or more than there is room for.
    """
    about = system.info(url)
    if about.get("type") == "directory":
        raise LogError("a folder on a server", where=where, advice="name the files in it one by one")
    size = about.get("size")
    if size is None:
        return None
    if size > most:
        raise _too_large(where, most)
    if size > shutil.disk_usage(tempfile.gettempdir()).free:
        advice = "set TMPDIR to a folder with room, or copy the file yourself"
        raise LogError(f"no room for {size >> 20} MiB", where=where, advice=advice)
    return int(size)


def _copy(system: AbstractFileSystem, url: str, copy: Path, most: int) -> int:
    """Copy in pieces, whatever the server said of the size; return the bytes that came.

    Raises:
        LogError: more comes than is allowed, or it comes too slowly.
    """
    in_one_answer = {"block_size": 0} if url.startswith("http") else {}
    copied, began = 0, time.monotonic()
    with system.open(url, "rb", **in_one_answer) as source, copy.open("wb") as file:
        while block := source.read(_BLOCK):
            copied += len(block)
            if copied > most:
                raise _too_large(shown(url), most)
            if copied < _SLOWEST * (time.monotonic() - began - _PATIENCE):
                raise LogError(
                    f"the server is too slow: {copied} bytes in {time.monotonic() - began:.0f} s",
                    where=shown(url),
                    advice=_AGAIN,
                )
            file.write(block)
    return copied


def _too_large(where: str, most: int) -> LogError:
    advice = "if this is right, copy the file, and give the copy"
    return LogError(f"more than {most / 1024 / 1024:g} MiB", where=where, advice=advice)


def _failure(error: Exception, url: str, where: str) -> LogError:
    """Say in one line what went wrong, without what the address keeps secret."""
    while isinstance(error, FileNotFoundError) and isinstance(error.__cause__, Exception):
        error = error.__cause__  # fsspec says of all that fails on the web that there is no such file
    if isinstance(error, FileNotFoundError) or getattr(error, "status", None) == _NOT_FOUND:
        return LogError("no such file on the server", where=where, advice="check the address")
    if isinstance(error, PermissionError):
        return LogError("no permission to read", where=where, advice="log in as the store's own tools do")
    said = " ".join(str(error).replace(url, where).split())
    user = url.partition("://")[2].partition("/")[0].rpartition("@")[0]
    for secret in (url.partition("?")[2], f"{user}@" if user else ""):
        said = said.replace(secret, "...") if secret else said
    what = f"cannot be fetched: {type(error).__name__}{f': {said[:200]}' if said else ''}"
    return LogError(what, where=where, advice=_AGAIN)


def _name(where: str) -> str:
    """Return a name for the copy that is safe on this machine, with the endings of the file."""
    name = re.sub(r"[^A-Za-z0-9._-]", "_", PurePosixPath(where).name)[-100:].lstrip(".")
    return name or "log"

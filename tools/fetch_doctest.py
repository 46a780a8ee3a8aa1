# SPDX-License-Identifier: Apache-2.0
"""Provides the one header of doctest where the compiler has none, out of a source package on PyPI."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PACKAGE = "gemmi"  # carries an untouched doctest 2.4.11
VERSION = "0.7.5"
MEMBER = f"{PACKAGE}-{VERSION}/third_party/doctest.h"
SHA256 = "253f7cc6938571f3319e76630c8256e4fb866ca85c53d39747d668137d9719a1"


def compiler_has_doctest() -> bool:
    """Tell whether the C++ compiler finds a doctest that the system or the user installed."""
    compiler = os.environ.get("CXX") or next(filter(shutil.which, ("c++", "g++", "clang++")), "c++")
    command = [*compiler.split(), "-x", "c++", "-E", "-"]
    found = subprocess.run(command, input=b"#include <doctest/doctest.h>\n", capture_output=True, check=False)
    return found.returncode == 0


def header_from(archive: Path) -> bytes:
    """Return doctest's header out of the source package.

    Raises:
        ValueError: the header is missing, or is not the expected one.
    """
    with tarfile.open(archive) as tar:
        try:
            member = tar.extractfile(MEMBER)
        except KeyError:
            member = None
        if member is None:
            raise ValueError(f"{archive.name} has no {MEMBER}")
        header = member.read()
    if hashlib.sha256(header).hexdigest() != SHA256:
        raise ValueError(f"{MEMBER} is not the expected file: its SHA-256 differs")
    return header


def download(folder: Path) -> Path:
    """Let pip bring the source package into `folder`, and return its path."""
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-binary", PACKAGE, "--dest", str(folder)]
    command = [sys.executable, "-m", "pip", "download", *options, f"{PACKAGE}=={VERSION}"]
    subprocess.run(command, check=True)
    return next(folder.glob(f"{PACKAGE}-*.tar.gz"))


def main(destination: Path) -> int:
    """Put `doctest/doctest.h` below `destination` unless it, or the compiler's own, is there."""
    target = destination / "doctest" / "doctest.h"
    if target.exists() or compiler_has_doctest():
        return 0
    with tempfile.TemporaryDirectory() as folder:
        try:
            header = header_from(download(Path(folder)))
        except (OSError, ValueError, tarfile.TarError, subprocess.CalledProcessError) as error:
            print(f"error: cannot fetch doctest: {error}; install doctest-dev instead", file=sys.stderr)
            return 2
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_suffix(".part")
    partial.write_bytes(header)
    partial.replace(target)
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))

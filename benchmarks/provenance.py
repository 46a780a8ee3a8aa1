# SPDX-License-Identifier: Apache-2.0
"""On what the figures were measured: machine, versions, state of the code, and hashes of the logs."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from slipwise.files import sha256_of

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("slipwise", "numpy", "pyarrow", "filterpy", "scipy", "numba", "jax", "casadi")


@dataclass(frozen=True)
class Provenance:
    """Everything that is needed to judge or repeat the figures; no names of hosts or folders."""

    processor: str
    cores: int
    memory_gigabytes: float
    system: str
    compiler: str
    python: str
    packages: dict[str, str]
    commit: str
    data: dict[str, str]  # sha256 by file below SLIPWISE_DATA

    @property
    def data_sha256(self) -> str:
        """One hash of all logs: of their names and hashes, sorted."""
        lines = "".join(f"{digest}  {name}\n" for name, digest in sorted(self.data.items()))
        return hashlib.sha256(lines.encode()).hexdigest()


def provenance(data: Path | None) -> Provenance:
    """Look at the machine, the environment, the working tree and the logs."""
    return Provenance(
        processor=_processor(),
        cores=os.cpu_count() or 1,
        memory_gigabytes=os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9,
        system=f"{platform.system()} {platform.release().split('-')[0]}, {platform.machine()}",
        compiler=_first_line(["c++", "--version"]),
        python=f"{platform.python_implementation()} {platform.python_version()}",
        packages={name: version(name) for name in PACKAGES},
        commit=_commit(),
        data=_hashes(data) if data else {},
    )


def _processor() -> str:
    """Return the processor's model, and its family where the name says little."""
    known: dict[str, str] = {}
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8", errors="replace").splitlines():
            key, _, value = line.partition(":")
            known.setdefault(key.strip(), value.strip())
    name = known.get("model name", platform.processor() or platform.machine())
    family = (f"family {known['cpu family']}, model {known['model']}",) if "cpu family" in known else ()
    return ", ".join((name, *family))


def _commit() -> str:
    """Return the commit, marked where files differ from it."""
    commit = _first_line(["git", "rev-parse", "--short=12", "HEAD"])
    changed = _first_line(["git", "status", "--porcelain", "--untracked-files=no"])
    return f"{commit}, with changes" if changed else commit


def _hashes(data: Path) -> dict[str, str]:
    files = sorted([*data.rglob("*.csv.gz"), *data.glob("reference.csv")])
    return {path.relative_to(data).as_posix(): sha256_of(path) for path in files}


def _first_line(command: list[str]) -> str:
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return "unknown"
    return next(iter(done.stdout.splitlines()), "")

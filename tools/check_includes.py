# SPDX-License-Identifier: Apache-2.0
"""Checks what the C++ core includes: own header first, lower layers, standard library, Eigen; no circle."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

#: Folders of the core, lowest first; folders of one row do not know each other.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("archive",),
    ("lie", "linear"),
    ("vehicle", "slip", "actuator", "terrain"),
    ("motion",),
    ("sensor",),
    ("segment", "rollout"),
    ("filter", "planning"),
    ("disturbance", "identify", "dynamics"),
    ("hypotheses",),
    ("online",),
    ("thesis",),  # the package slipwise-thesis
)
LEVEL = {folder: level for level, row in enumerate(LAYERS) for folder in row}

PARTS = ("cpp", "packages/slipwise-thesis/cpp")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
OWN = "slipwise/"
SOURCES = (".cpp", ".hpp", ".cu")
CUDA = "cuda_runtime.h"  # in .cu files only


@dataclass(frozen=True)
class Include:
    """One include line of a source file, whose path is relative to the repository."""

    path: str
    line: int
    target: str


def includes(root: Path) -> Iterator[Include]:
    """Yield every include of the headers and sources of the core, and of packages beside it, below `root`."""
    for folder in (f"{part}/{kind}" for part in PARTS for kind in ("include/slipwise", "src")):
        for path in sorted(p for p in (root / folder).rglob("*") if p.suffix in SOURCES):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                if found := INCLUDE.match(line):
                    yield Include(path.relative_to(root).as_posix(), number, found[2])


def layer_of(path: str) -> str:
    """Return the folder of the core that the file or the included header `path` is in, "" outside of one."""
    parts = re.sub(r"^(.*cpp/include/slipwise/|.*cpp/src/|slipwise/)", "", path).split("/")
    return parts[0] if len(parts) > 1 else ""


def layer_fault(include: Include) -> str:
    """Say what is wrong with one include, or return an empty string."""
    layer = layer_of(include.path)
    if layer not in LEVEL:
        return f"'{layer or '.'}' is not a layer; the layers stand in tools/check_includes.py"
    if not include.target.startswith(OWN):
        return "" if is_cuda(include) else foreign_fault(include.target)
    target = layer_of(include.target)
    if target not in LEVEL:
        return f"includes {include.target}, which is in no layer"
    if layer != target and LEVEL[target] >= LEVEL[layer]:
        return f"'{layer}' must not include {include.target}: '{target}' is not below it"
    return ""


def is_cuda(include: Include) -> bool:
    """Return whether CUDA's header is included where it may be."""
    return include.target == CUDA and include.path.endswith(".cu")


def foreign_fault(target: str) -> str:
    """Say why a header from elsewhere may not be included, or return an empty string."""
    if target.startswith("Eigen/"):
        return ""
    if re.fullmatch(r"[a-z0-9_]+", target):  # a header of the standard library has no extension
        return ""
    return f'includes {target}; the core uses the standard library, Eigen and "slipwise/..." only'


def order_fault(include: Include, root: Path) -> str:
    """Say that a source does not begin with its own header, where clang-tidy reads that header by itself."""
    part, _, source = include.path.rpartition("/src/")
    own = re.sub(r"^(.+)\.(cpp|cu)$", rf"{OWN}\1.hpp", source)
    if not source or own == include.target or not (root / part / "include" / own).exists():
        return ""
    return f"includes {include.target} before its own header, {own}"


def cycles(graph: Mapping[str, set[str]]) -> list[str]:
    """Return a message for the first include cycle of `graph` (header -> headers it includes)."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return [f"headers include each other: {' <- '.join(error.args[1])}"]
    return []


def check(root: Path) -> list[str]:
    """Return all faults of the core below `root`, one message each."""
    faults: list[str] = []
    graph: dict[str, set[str]] = {}
    before = ""
    for include in includes(root):
        first, before = include.path != before, include.path
        found = (layer_fault(include), order_fault(include, root) if first else "")
        faults.extend(f"{include.path}:{include.line}: {fault}" for fault in found if fault)
        _, header, name = include.path.rpartition("cpp/include/")
        if header:
            graph.setdefault(name, set()).add(include.target)
    return faults + cycles(graph)


def main(root: Path) -> int:
    """Print the faults; return 1 if there are any."""
    faults = check(root)
    print("\n".join(faults) if faults else "C++ layers: no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))

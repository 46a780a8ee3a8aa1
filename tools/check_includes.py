# SPDX-License-Identifier: Apache-2.0
"""Checks what the C++ core includes: own header first, lower layers, standard library, Eigen; no circle.

A name of the standard library comes from a header that is included, by the file itself or by one that
it includes. Compilers find that out for some names alone: one standard header brings others along, and
so do a precompiled header and a source that is read before this one.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
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

#: Header -> the names of namespace std that it is included for.
STANDARD = {
    "algorithm": "clamp|max|min|sort|stable_sort|nth_element|lower_bound|upper_bound|equal_range|copy|"
    "copy_n|fill|fill_n|find|find_if|count_if|any_of|all_of|none_of|max_element|min_element|equal|"
    r"minmax_element|transform|reverse|rotate|partition_point|remove_if|unique|ranges::\w+",
    "array": "array",
    "cmath": "abs|sqrt|cbrt|hypot|a?sin|a?cos|a?tan|atan2|sinh|cosh|tanh|exp|expm1|log|log1p|pow|erfc?|"
    "floor|ceil|trunc|round|l?lround|fmod|remainder|fma|fabs|fmax|fmin|copysign|nextafter|signbit|"
    "isfinite|isnan",
    "deque": "deque",
    "functional": "function",
    "limits": "numeric_limits",
    "memory": "unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared",
    "optional": "optional|nullopt|make_optional",
    "span": "span",
    "stdexcept": "invalid_argument|out_of_range|(?:domain|length|logic|overflow|runtime)_error",
    "string": "string|to_string",
    "variant": "variant|visit|holds_alternative|get_if|monostate",
    "vector": "vector",
}
STANDARD_NAMES = {header: re.compile(rf"\bstd::(?:{names})\b") for header, names in STANDARD.items()}
#: What a header declares: a type or a constant.
DECLARED = re.compile(
    r"^ *(?:(?:struct|class|enum class|enum) (\w+)(?= [{:]| final)|using (\w+) =|inline .*?\b(k[A-Z]\w*))",
    re.MULTILINE,
)
NO_CODE = re.compile(r'//.*|"(?:[^"\\]|\\.)*"')


@dataclass(frozen=True)
class Include:
    """One include line of a source file, whose path is relative to the repository."""

    path: str
    line: int
    target: str


def files(root: Path) -> Iterator[Path]:
    """Yield the headers and sources of the core, and of packages beside it, below `root`."""
    for folder in (f"{part}/{kind}" for part in PARTS for kind in ("include/slipwise", "src")):
        yield from sorted(p for p in (root / folder).rglob("*") if p.suffix in SOURCES)


def includes(root: Path) -> Iterator[Include]:
    """Yield every include of the headers and sources of the core, and of packages beside it, below `root`."""
    for path in files(root):
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
    """Say that a source does not begin with its own header."""
    part, _, source = include.path.rpartition("/src/")
    own = re.sub(r"^(.+)\.(cpp|cu)$", rf"{OWN}\1.hpp", source)
    if not source or own == include.target or not (root / part / "include" / own).exists():
        return ""
    return f"includes {include.target} before its own header, {own}"


def closures(direct: Mapping[str, set[str]]) -> dict[str, frozenset[str]]:
    """Return what each file includes, itself or by others, from what each includes itself: no circle."""

    @cache
    def closure(name: str) -> frozenset[str]:
        own = direct.get(name, set())
        return frozenset(own).union(*(closure(each) for each in own))

    return {name: closure(name) for name in direct}


def name_faults(root: Path, graph: Mapping[str, set[str]]) -> Iterator[str]:
    """Say which files use names of the standard library, or Eigen, without a header that has them."""
    within, own = closures(graph), own_names(root)
    used = re.compile(rf"(?<![\w.>:/])(?:{'|'.join(sorted(own))})\b") if own else None
    for path in files(root):
        name, code = path.relative_to(root).as_posix(), NO_CODE.sub("", path.read_text(encoding="utf-8"))
        headers = within.get(name_of(name), frozenset())
        for header, names in STANDARD_NAMES.items():
            if header not in headers and (found := names.search(code)):
                yield f"{name}: {found[0]} without <{header}>"
        if "Eigen::" in code and not any(each.startswith("Eigen/") for each in headers):
            yield f"{name}: Eigen:: without a header of Eigen"
        if used is not None and path.suffix == ".cpp":  # each header is compiled alone
            missing = {each for each in used.findall(code) if own[each] not in headers}
            for found in sorted(each for each in missing if not defines(code, each)):
                yield f"{name}: {found} without {own[found]}"


def own_names(root: Path) -> dict[str, str]:
    """Return which header declares each name that one header alone does."""
    found: dict[str, set[str]] = {}
    for path in files(root):
        name = name_of(path.relative_to(root).as_posix())
        if name.startswith(OWN):
            for each in DECLARED.finditer(path.read_text(encoding="utf-8")):
                found.setdefault(next(filter(None, each.groups())), set()).add(name)
    return {name: next(iter(headers)) for name, headers in found.items() if len(headers) == 1}


def defines(code: str, name: str) -> bool:
    """Return whether a source has a type, a constant or a parameter of a template with this name itself."""
    return bool(
        re.search(rf"\b(?:struct|class|enum|using|typename|constexpr [^;=]*|TUNING\() ?{name}\b", code)
    )


def name_of(path: str) -> str:
    """Return how others include a header; a source is what it is called."""
    return path.rpartition("cpp/include/")[2]


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
    for include in includes(root):
        before = graph.setdefault(name_of(include.path), set())
        found = (
            layer_fault(include),
            "" if before else order_fault(include, root),
            f"includes {include.target} twice" if include.target in before else "",
        )
        faults.extend(f"{include.path}:{include.line}: {fault}" for fault in found if fault)
        before.add(include.target)
    circles = cycles(graph)
    return faults + (circles or list(name_faults(root, graph)))


def main(root: Path) -> int:
    """Print the faults; return 1 if there are any."""
    faults = check(root)
    print("\n".join(faults) if faults else "C++ layers: no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))

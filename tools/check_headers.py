# SPDX-License-Identifier: Apache-2.0
"""Compiles every header of the C++ core as if it stood alone, many of them in one run of the compiler."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from graphlib import TopologicalSorter
from itertools import pairwise
from pathlib import Path

from tools.check_includes import ROOT, closures, files, includes, name_of

EIGEN = "Eigen/Core"  # what takes longest to read
BUILD = Path("build/headers")
COMMANDS = Path("build/tidy/compile_commands.json")

#: Header -> all that it includes, itself or by others.
Closures = Mapping[str, frozenset[str]]


def headers_of(root: Path) -> Closures:
    """Return what each header below `root` includes, itself or by others."""
    direct: dict[str, set[str]] = {name_of(str(path)): set() for path in files(root) if path.suffix == ".hpp"}
    for include in includes(root):
        if name_of(include.path) in direct:
            direct[name_of(include.path)].add(include.target)
    return closures(direct)


def chains(within: Closures) -> list[list[str]]:
    """Return the headers as few chains, in each of which the next includes all before it.

    One run of the compiler over a chain is a test of each of its headers: what was read before a
    header is what it includes anyway, so that it sees nothing that it would not see alone. Few
    chains are a largest matching of headers with others that include them (Dilworth, Kuhn).
    """
    order = [name for name in TopologicalSorter(within).static_order() if name in within]
    includers = {name: [each for each in order if name in within[each]] for name in order}
    before: dict[str, str] = {}  # header -> the one that stands before it in its chain

    def has_next(name: str, tried: set[str]) -> bool:
        for each in includers[name]:
            if each not in tried:
                tried.add(each)
                if each not in before or has_next(before[each], tried):
                    before[each] = name
                    return True
        return False

    for name in reversed(order):
        has_next(name, set())
    after = {first: then for then, first in before.items()}
    found = []
    for name in (each for each in order if each not in before):
        chain = [name]
        while chain[-1] in after:
            chain.append(after[chain[-1]])
        found.append(chain)
    return found


def compiler_and_flags(commands: Path) -> list[str]:
    """Return the compiler, its standard and its folders of headers, as CMake gives them to the sources."""
    words: dict[str, None] = {}
    for entry in json.loads(commands.read_text(encoding="utf-8")):
        command = shlex.split(entry["command"])
        compiler = next(word for word in command if not word.endswith("ccache"))
        for word, value in pairwise([*command, ""]):
            if word.startswith(("-std=", "-I")):
                words[word] = None
            elif word == "-isystem":
                words[f"-isystem{value}"] = None
    return [compiler, *words]


def compile_chain(command: list[str], chain: Iterable[str], before: Path | None) -> str:
    """Return what the compiler says of a chain of headers, an empty text where they are complete."""
    text = "".join(f'#include "{name}"\n' for name in chain)
    first = ("-Winvalid-pch", "-include", str(before)) if before else ()
    given = [*command, *first, "-fsyntax-only", "-x", "c++", "-"]
    done = subprocess.run(given, input=text, capture_output=True, text=True, check=False)
    return done.stderr if done.returncode or done.stderr else ""


def faults(root: Path) -> list[str]:
    """Return what the compiler says of headers that are not complete by themselves."""
    within = headers_of(root)
    command = compiler_and_flags(root / COMMANDS)
    eigen = root / BUILD / "eigen.hpp"
    eigen.parent.mkdir(parents=True, exist_ok=True)
    eigen.write_text(f"#include <{EIGEN}>\n", encoding="utf-8")
    subprocess.run([*command, "-x", "c++-header", str(eigen), "-o", f"{eigen}.gch"], check=True)
    with_eigen = {name: each for name, each in within.items() if EIGEN in each}
    without = {name: each for name, each in within.items() if name not in with_eigen}
    work = [(chain, eigen) for chain in chains(with_eigen)] + [(chain, None) for chain in chains(without)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        said = pool.map(lambda each: compile_chain(command, *each), work)
    print(f"headers: {len(within)} compiled in {len(work)} runs")
    return [text for text in said if text]


def main() -> int:
    """Print what is wrong; return 1 if anything is."""
    found = faults(ROOT)
    print("\n".join(found) or "headers: no fault")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over the sources of the C++ core, several as one text.

Most of a run goes into reading the headers and into templates that the next source uses too. As one
text, sources need less than half of the time; all of it is of the main file, so that no check looks
away. What they would hide from each other, a missing include, is found by tools/check_includes.py.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tools.check_includes import INCLUDE, ROOT

BUILD = ROOT / "build/tidy"
TOGETHER = BUILD / "together"
MOST_SOURCES = 8  # of a folder, which CMakeLists.txt compiles together too
SOURCES = re.compile(r"/cpp/src/")
NOT_COMPILED = "[clang-diagnostic-error]"


@dataclass(frozen=True)
class Source:
    """A source and the command that compiles it."""

    path: Path
    command: tuple[str, ...]  # without the names of files

    @property
    def text(self) -> str:
        """Return what stands in the file."""
        return self.path.read_text(encoding="utf-8")


@dataclass(frozen=True)
class Group:
    """Sources that are read as one text."""

    sources: list[Source]

    @property
    def lines(self) -> int:
        """Return the number of lines of all sources."""
        return sum(each.text.count("\n") for each in self.sources)


def sources_of(commands: Path) -> list[Source]:
    """Return the sources of the core and of packages beside it, with their commands."""
    found = []
    for entry in json.loads(commands.read_text(encoding="utf-8")):
        path = Path(entry["file"])
        if SOURCES.search(path.as_posix()) and path.suffix == ".cpp":
            command = re.sub(r" -(?:MD|MT \S+|MF \S+|o \S+|c \S+)(?= |$)", "", entry["command"])
            found.append(Source(path, tuple(shlex.split(command))))
    return found


def groups_of(sources: list[Source]) -> list[Group]:
    """Return the sources in groups of a folder, the largest first; one with options of its own is alone."""
    folders: dict[Path, list[Source]] = {}
    for source in sorted(sources, key=lambda each: each.path):
        folders.setdefault(source.path.parent, []).append(source)
    groups = []
    for folder in folders.values():
        usual, _ = Counter(each.command for each in folder).most_common(1)[0]
        groups += [Group([each]) for each in folder if each.command != usual]
        for first in range(0, len(folder), MOST_SOURCES):
            together = folder[first : first + MOST_SOURCES]
            groups.append(Group([each for each in together if each.command == usual]))
    return sorted((each for each in groups if each.sources), key=lambda each: -each.lines)


def written(group: Group, path: Path) -> list[tuple[Path, int]]:
    """Write a group's text; return the file and line of each of its lines. A header is included once."""
    seen: set[str] = set()
    lines, origins = [], []
    for source in group.sources:
        for number, line in enumerate(source.text.splitlines(), start=1):
            found = INCLUDE.match(line)
            lines.append("" if found and found[2] in seen else line)
            seen |= {found[2]} if found else set()
            origins.append((source.path, number))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return origins


def run(folder: Path, files: list[Path]) -> str:
    """Return what clang-tidy says of files with commands in `folder`; an empty text where it says nothing."""
    command = ("clang-tidy", "-quiet", f"-p={folder}", *map(str, files))
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr if done.returncode else ""


def said_of(group: Group, path: Path, origins: list[tuple[Path, int]]) -> str:
    """Return what clang-tidy says of a group, at the places where it stands in the sources."""
    said = run(TOGETHER, [path])
    if NOT_COMPILED in said:  # sources that cannot be read together, or one that is wrong: each alone
        print(f"clang-tidy: {path.name} does not compile: its {len(group.sources)} sources, each alone")
        return run(BUILD, [each.path for each in group.sources])

    lines, here = [], False
    for line in said.splitlines():
        if found := re.match(rf"{re.escape(str(path))}:(\d+):", line):
            source, number = origins[int(found[1]) - 1]
            lines.append(f"{source}:{number}:{line[found.end() :]}")
        elif here and (found := re.match(r" *(\d+) \|", line)):  # the line itself, with its number
            lines.append(f"{origins[int(found[1]) - 1][1]:>5}{line[found.end(1) :]}")
        else:
            lines.append(line)
        here = line.startswith(str(path)) or (here and line.startswith(" "))
    return "\n".join(lines)


def main(pattern: str = "") -> int:
    """Print what clang-tidy finds in the sources whose path matches `pattern`; return 1 if anything."""
    sources = sources_of(BUILD / "compile_commands.json")
    chosen = {each.path for each in sources if re.search(pattern, str(each.path))}
    groups = [
        Group(here)
        for group in groups_of(sources)
        if (here := [each for each in group.sources if each.path in chosen])
    ]
    TOGETHER.mkdir(parents=True, exist_ok=True)
    work, commands = [], []
    for number, group in enumerate(groups):
        path = TOGETHER / f"{group.sources[0].path.parent.name}_{number}.cpp"
        work.append((group, path, written(group, path)))
        command = [*group.sources[0].command, "-c", str(path)]
        commands.append({"directory": str(BUILD), "file": str(path), "arguments": command})
    (TOGETHER / "compile_commands.json").write_text(json.dumps(commands), encoding="utf-8")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        said = [text for text in pool.map(lambda each: said_of(*each), work) if text]
    print("\n".join([*said, f"clang-tidy: {len(chosen)} sources, {'faults' if said else 'no fault'}"]))
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

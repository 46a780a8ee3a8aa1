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
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from tools.check_includes import INCLUDE, ROOT

BUILD = ROOT / "build/tidy"
TOGETHER = BUILD / "together"
MOST_SOURCES, MOST_LINES = 10, 1400  # of one text: 1 to 2 GB of memory
SOURCES = re.compile(r"/cpp/src/")
INCLUDED_FROM = (ROOT / "cpp/include", ROOT / "packages/slipwise-thesis/cpp/include")
MARGIN, CONSTANT = re.compile(r"^[^\s/].*", re.MULTILINE), re.compile(r"\bk[A-Z]\w*")
NOT_COMPILED = "[clang-diagnostic-error]"

#: What a source defines for itself alone: a constant, a type, an alias, a function.
OWN_NAME = re.compile(
    r"^(?:SLIPWISE_TUNING\((?P<tuned>\w+)"
    r"|#\s*define\s+(?P<macro>\w+)"
    r"|using\s+(?P<alias>\w+)\s*="
    r"|(?:struct|class|enum class|enum|namespace)\s+(?P<type>\w+)"
    r"|(?![\s#}/]|using\b|template\b)[\w:<>,&*\s\[\]]*?(?<!::)\b(?P<value>\w+)\s*[({=;\[])"
)


@dataclass(frozen=True)
class Source:
    """A source and the command that compiles it."""

    path: Path
    command: tuple[str, ...]  # without the names of files

    @property
    def text(self) -> str:
        """Return what stands in the file."""
        return self.path.read_text(encoding="utf-8")

    def own_names(self) -> set[str]:
        """Return the names at the left margin; two sources with one of them are not read together."""
        found = (OWN_NAME.match(line) for line in self.text.splitlines())
        names = {name for each in found if each for name in each.groups() if name}
        return names - {"slipwise", "namespace"}

    def included_constants(self) -> set[str]:
        """Return the constants of the headers that it includes; another source may have one of its own."""
        return set().union(*(constants_of(name) for name in included(self.text)))


def included(text: str) -> list[str]:
    """Return the names of this repository's headers that a text includes."""
    found = (INCLUDE.match(line) for line in text.splitlines())
    return [each[2] for each in found if each and each[2].startswith("slipwise/")]


@cache
def constants_of(name: str) -> frozenset[str]:
    """Return the constants of a header and of those that it includes."""
    path = next((each / name for each in INCLUDED_FROM if (each / name).exists()), None)
    text = "" if path is None else path.read_text(encoding="utf-8")
    here = (each for line in MARGIN.findall(text) for each in CONSTANT.findall(line))
    return frozenset(here).union(*map(constants_of, included(text)))


@dataclass
class Group:
    """Sources that are read as one text."""

    sources: list[Source] = field(default_factory=list)
    names: set[str] = field(default_factory=set)
    constants: set[str] = field(default_factory=set)  # of headers
    lines: int = 0

    def takes(self, source: Source, names: set[str], constants: set[str], lines: int) -> bool:
        """Return whether a source may be read with those that are here."""
        first = self.sources[0]
        return (
            len(self.sources) < MOST_SOURCES
            and self.lines + lines <= MOST_LINES
            and source.command == first.command
            and not names & (self.names | self.constants)
            and not constants & self.names
        )


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
    """Return the sources in groups that can be read as one text, the largest first."""
    groups: list[Group] = []
    for source in sorted(sources, key=lambda each: each.path):
        names, constants, lines = source.own_names(), source.included_constants(), source.text.count("\n")
        group = next((each for each in groups if each.takes(source, names, constants, lines)), None)
        if group is None:
            group = Group()
            groups.append(group)
        group.sources.append(source)
        group.names |= names
        group.constants |= constants
        group.lines += lines
    return sorted(groups, key=lambda each: -each.lines)


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
    sources = [
        each for each in sources_of(BUILD / "compile_commands.json") if re.search(pattern, str(each.path))
    ]
    groups = groups_of(sources)
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
    print("\n".join([*said, f"clang-tidy: {len(sources)} sources, {'faults' if said else 'no fault'}"]))
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

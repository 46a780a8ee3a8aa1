# SPDX-License-Identifier: Apache-2.0
"""Makes the site's page of source files from the sentence that each file starts with."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SOURCES = (".py", ".sh", ".hpp", ".cpp", ".cu")
LICENCE = "SPDX-License-Identifier"
#: Folders on the page, with all below them; those of one line share a table.
TOPS = (
    ("cpp/include/slipwise", "cpp/src"),
    ("python/bindings",),
    ("python/slipwise",),
    ("packages/slipwise-sim/slipwise_sim",),
    ("packages/slipwise-thesis/cpp",),
    ("packages/slipwise-thesis/slipwise_thesis",),
    ("ros",),
    ("tools",),
    ("examples",),
)


def sentence_of(path: Path) -> str:
    """Return the sentence below the licence line: a comment, or the first line of the docstring."""
    lines = path.read_text(encoding="utf-8").splitlines()
    start = next((i + 1 for i, line in enumerate(lines) if LICENCE in line), 0)
    while start < len(lines) and (not lines[start].strip() or lines[start].startswith("# %%")):
        start += 1
    if start < len(lines) and lines[start].startswith('"""'):
        return lines[start].strip('"')
    mark = "//" if path.suffix in (".hpp", ".cpp", ".cu") else "#"
    words: list[str] = []
    for line in lines[start:]:
        if not line.startswith(mark):
            break
        words.append(line.removeprefix(mark).strip())
    return " ".join(words)


def sources() -> Iterator[tuple[str, Path]]:
    """Yield every source file with the heading that it stands below."""
    for tops in TOPS:
        for top in tops:
            for path in sorted((ROOT / top).rglob("*")):
                if path.suffix in SOURCES and not path.name.startswith("_core"):
                    below = path.parent.relative_to(ROOT / top)
                    yield str(Path(tops[0]) / below), path


def page() -> str:
    """Return the page: a table for each folder; files of one stem share a row."""
    lines = ["# Files", "", "Every source file, with the sentence that it starts with.", ""]
    for heading, group in groupby(sorted(sources(), key=lambda each: each[0]), key=lambda each: each[0]):
        lines += [f"## {heading}", "", "| file | what it is for |", "|---|---|"]
        paths = sorted((path for _, path in group), key=lambda path: path.stem)
        for _, same in groupby(paths, key=lambda path: path.stem):
            files = list(same)
            names = ", ".join(f"`{path.name}`" for path in files)
            lines.append(f"| {names} | {sentence_of(files[0]).replace('|', chr(92) + '|')} |")
        lines.append("")
    return "\n".join(lines)


def on_files(files: Any, config: Any) -> Any:
    """Add the page."""
    from mkdocs.structure.files import File

    files.append(File.generated(config, "files.md", content=page()))
    return files

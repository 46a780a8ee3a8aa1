# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of files in docs/files.md from the sentence that each file starts with."""

from __future__ import annotations

import re
import sys
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "files.md"
SOURCES = (".py", ".sh", ".hpp", ".cpp", ".cu")
REGION = re.compile(r"<!-- files: (?P<folders>[^>]+) -->\n.*?<!-- end -->", re.DOTALL)
LICENCE = "SPDX-License-Identifier"
#: Folders below which every source file must stand in a table.
DESCRIBED = ("cpp/include", "cpp/src", "python/bindings", "python/slipwise", "tools", "examples", "docs")


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


def source_files(folder: Path) -> list[Path]:
    """Return the source files directly in `folder`."""
    files = [path for path in folder.iterdir() if path.suffix in SOURCES] if folder.is_dir() else []
    return sorted(path for path in files if not path.name.startswith("_core"))


def table(folders: list[str]) -> str:
    """Return a table of the files in some folders; files of one stem share a row and its first sentence."""
    found = [(path.stem, n, path) for n, folder in enumerate(folders) for path in source_files(ROOT / folder)]
    rows = ["| file | what it is for |", "|---|---|"]
    for _, group in groupby(sorted(found), key=lambda item: item[0]):
        paths = [path for _, _, path in group]
        names = ", ".join(f"`{path.name}`" for path in paths)
        rows.append(f"| {names} | {sentence_of(paths[0]).replace('|', chr(92) + '|')} |")
    return "\n".join(rows)


def rewritten(text: str) -> str:
    """Return the page with every table of files made again."""

    def region(match: re.Match[str]) -> str:
        folders = match["folders"].split()
        return f"<!-- files: {match['folders']} -->\n{table(folders)}\n<!-- end -->"

    return REGION.sub(region, text)


def folders_named(text: str) -> set[str]:
    """Return the folders that have a table."""
    return {folder for match in REGION.finditer(text) for folder in match["folders"].split()}


def folders_needed() -> set[str]:
    """Return the folders that hold a source file which must be described."""
    tops = [ROOT / top for top in DESCRIBED]
    holding = {path.parent for top in tops for path in top.rglob("*") if path in source_files(path.parent)}
    return {str(folder.relative_to(ROOT)) for folder in holding if "__pycache__" not in folder.parts}


def main() -> int:
    """Rewrite the page; return 1 if a folder has no table."""
    PAGE.write_text(rewritten(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    missing = folders_needed() - folders_named(PAGE.read_text(encoding="utf-8"))
    sys.stderr.writelines(f"no table for {folder}\n" for folder in sorted(missing))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())

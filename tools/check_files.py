# SPDX-License-Identifier: Apache-2.0
"""Checks every tracked source file: its length, its licence line, its name and its words."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent

MAX_LINES = 400
VAGUE_NAMES = frozenset({"util", "utils", "helper", "helpers", "common", "misc", "base", "manager"})
LICENCE = "SPDX-License-Identifier: Apache-2.0"
#: Words that a term of the field has replaced in the product, by how they begin (docs/notation.md).
RETIRED = {
    "anew": "again",
    "belief": "posterior",
    "colouredslip": "slip disturbance",
    "commandchain": "actuator model",
    "contender": "candidate, or baseline in evaluations",
    "exhibit": "figure or table",
    "forecaster": "predictor",
    "foretell": "predict",
    "foretold": "predicted",
    "groundchange": "terrain change",
    "inputtrack": "input history",
    "knowndrive": "measured actuator",
    "lanelimits": "axis limits",
    "limitedtrack": "limited inputs",
    "lookalike": "confounded parameters",
    "plainmodel": "kinematic baseline",
    "reweighed": "updated weights",
    "richest": "largest basis",
    "slowlag": "slow time constant",
    "slowpart": "slow mode",
    "slowshare": "slow fraction",
    "wander": "slip disturbance",
    "weighing": "weighting",
    "withmount": "with extrinsics",
}
OF_OLDER_FILES = "python/slipwise/models/upgrade.py"  # has to name what older files call things
PRODUCT = ("cpp/include/", "cpp/src/", "python/bindings/", "python/slipwise/", "packages/")
#: How the licence line starts, by the ending or the name of a file; files of other kinds are not looked at.
COMMENTS = {
    ".py": "# ",
    ".sh": "# ",
    ".cmake": "# ",
    ".in": "# ",
    ".cpp": "// ",
    ".hpp": "// ",
    ".cu": "// ",
    "CMakeLists.txt": "# ",
    "Makefile": "# ",
    ".ci/run": "# ",
}


def comment_of(path: str) -> str | None:
    """Return how a comment starts in the source file `path`, or None when it is no source file."""
    pure = PurePosixPath(path)
    return COMMENTS.get(path) or COMMENTS.get(pure.name) or COMMENTS.get(pure.suffix)


def faults_of(path: str, text: str) -> list[str]:
    """Return what is wrong with the source file `path` (relative to the repository) that holds `text`."""
    comment = comment_of(path)
    if comment is None:
        return []
    faults = []
    lines = text.splitlines()
    if len(lines) > MAX_LINES:
        faults.append(f"{path}: {len(lines)} lines; split it by concept, {MAX_LINES} are the limit")
    first = lines[1:2] if lines and lines[0].startswith("#!") else lines[:1]
    if first != [comment + LICENCE]:
        faults.append(f"{path}: does not start with '{comment}{LICENCE}'")
    if PurePosixPath(path).stem.lower() in VAGUE_NAMES:
        faults.append(f"{path}: name the file after the concept it holds")
    if path.startswith(PRODUCT) and "/tests/" not in path and path != OF_OLDER_FILES:
        faults += [f"{path}: '{word}' is retired; write {RETIRED[word]}" for word in retired_words(text)]
    return faults


def retired_words(text: str) -> list[str]:
    """Return the retired words that words or parts of identifiers in `text` begin with, each once."""
    found: set[str] = set()
    for name in set(re.findall(r"[A-Za-z_]+", text)):
        parts = [part.lower() for part in re.findall(r"[A-Z]?[a-z]+", name)]
        found |= {"".join(parts[i:]) for i in range(len(parts))}
    return [word for word in RETIRED if any(part.startswith(word) for part in found)]


def tracked(root: Path) -> list[str]:
    """Return the files that git tracks, or would track, below `root` and that exist."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, capture_output=True, check=True).stdout.decode()
    return sorted({path for path in listing.split("\0") if path and (root / path).is_file()})


def check(root: Path) -> list[str]:
    """Return all faults of the source files below `root`, one message each."""
    faults: list[str] = []
    for path in tracked(root):
        if comment_of(path) is not None:
            faults += faults_of(path, (root / path).read_text(encoding="utf-8"))
    return faults


def main(root: Path) -> int:
    """Print the faults; return 1 if there are any."""
    faults = check(root)
    print("\n".join(faults) if faults else "files: no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))

# SPDX-License-Identifier: Apache-2.0
"""Prints what pyproject.toml requires, so that `make` can install it before slipwise itself is built."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent


def requirements(project: dict[str, Any], part: str) -> list[str]:
    """Return the requirements of `part`: "build", "run", an extra, a dependency group, or a package's folder.

    An extra that names others of the project, as in "slipwise[plot,sim]", stands for theirs.

    Raises:
        KeyError: there is no such part.
    """
    if part == "build":
        return list(project["build-system"]["requires"])
    if part.startswith("packages/"):
        beside = tomllib.loads((ROOT / part / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        return [line for line in beside["dependencies"] if not line.startswith(project["project"]["name"])]
    if part == "run":
        return list(project["project"]["dependencies"])
    extras = project["project"].get("optional-dependencies", {})
    groups = project.get("dependency-groups", {})
    own = re.compile(re.escape(project["project"]["name"]) + r"\[(.+)\]")
    found: list[str] = []
    for requirement in (extras | groups)[part]:
        others = own.fullmatch(requirement)
        parts = others.group(1).split(",") if others else []
        found += (
            [line for other in parts for line in requirements(project, other)] if others else [requirement]
        )
    return found


def main(parts: list[str]) -> int:
    """Print the requirements of all `parts`, each once, one a line."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    print("\n".join(dict.fromkeys(line for part in parts for line in requirements(project, part))))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

# SPDX-License-Identifier: Apache-2.0
"""Prints what pyproject.toml requires, so that `make` can install it before slipwise itself is built."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent


def requirements(project: dict[str, Any], part: str) -> list[str]:
    """Return the requirements of `part`: "build", "run", an extra, or a dependency group.

    Raises:
        KeyError: there is no such part.
    """
    if part == "build":
        return list(project["build-system"]["requires"])
    if part == "run":
        return list(project["project"]["dependencies"])
    extras = project["project"].get("optional-dependencies", {})
    groups = project.get("dependency-groups", {})
    return list((extras | groups)[part])


def main(parts: list[str]) -> int:
    """Print the requirements of all `parts`, one a line."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for part in parts:
        print("\n".join(requirements(project, part)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

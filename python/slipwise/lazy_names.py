# SPDX-License-Identifier: Apache-2.0
"""Imports a package's public names at their first use, so that the command line starts at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any


def lazy_names(
    package: str, homes: Mapping[str, Sequence[str]], hints: Mapping[str, str] | None = None
) -> Callable[[str], Any]:
    """Return a package's `__getattr__` (PEP 562).

    Args:
        package: its name.
        homes: the modules that public names live in, with these names.
        hints: what to use in place of names that one might guess.
    """

    def get(name: str) -> Any:
        for home, names in homes.items():
            if name in names:
                return getattr(import_module(home), name)
        raise AttributeError(no_attribute(f"module '{package}'", name, hints or {}))

    return get


def no_attribute(owner: str, name: str, hints: Mapping[str, str]) -> str:
    """Return the message of an AttributeError, with what to use instead where that is known."""
    return f"{owner} has no attribute {name!r}" + (f"; use {hints[name]}" if name in hints else "")

# SPDX-License-Identifier: Apache-2.0
"""Every function of the compiled core with its parameters, read from the stub that the build writes."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import slipwise

_PROPERTIES = ("property", "setter")


@dataclass(frozen=True)
class Bound:
    """One bound function, method or constructor, or one of its overloads."""

    owner: str  # the class, empty for a function
    name: str
    parameters: tuple[tuple[str, str], ...]  # name and annotation, without self
    returns: str

    @property
    def title(self) -> str:
        """Name it as Python does."""
        return f"{self.owner}.{self.name}" if self.owner else self.name


@cache
def bound_functions() -> list[Bound]:
    """Return all of them, in the order of the stub."""
    tree = ast.parse((Path(slipwise.__file__).parent / "_core.pyi").read_text(encoding="utf-8"))
    found: list[Bound] = []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found.append(_bound("", node))
        elif isinstance(node, ast.ClassDef):
            found.extend(_bound(node.name, item) for item in node.body if _is_method(item))
    return found


def _is_method(node: ast.stmt) -> bool:
    if not isinstance(node, ast.FunctionDef):
        return False
    return not any(word in ast.unparse(mark) for mark in node.decorator_list for word in _PROPERTIES)


def _bound(owner: str, node: ast.stmt) -> Bound:
    assert isinstance(node, ast.FunctionDef)
    static = any(ast.unparse(mark) == "staticmethod" for mark in node.decorator_list)
    arguments = node.args.args[0 if not owner or static else 1 :]
    parameters = tuple((item.arg, ast.unparse(item.annotation or ast.Constant(""))) for item in arguments)
    return Bound(owner, node.name, parameters, ast.unparse(node.returns) if node.returns else "")

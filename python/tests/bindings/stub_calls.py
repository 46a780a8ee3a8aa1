# SPDX-License-Identifier: Apache-2.0
"""Every function of the compiled modules with its parameters, read from the stubs that the build writes."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import slipwise
import slipwise_thesis

_PROPERTIES = ("property", "setter")
_STUBS = {
    "slipwise._core": Path(slipwise.__file__).with_name("_core.pyi"),
    "slipwise_thesis._thesis": Path(slipwise_thesis.__file__).with_name("_thesis.pyi"),
}


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
    found: list[Bound] = []
    for stub in _STUBS.values():
        for node in ast.parse(stub.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                found.append(_bound("", node))
            elif isinstance(node, ast.ClassDef):
                found.extend(_bound(node.name, item) for item in node.body if _is_method(item))
    return found


def compiled(name: str) -> Any:
    """Return what has this name in one of the compiled modules, None where nothing has."""
    found = (getattr(import_module(module), name, None) for module in _STUBS)
    return next((each for each in found if each is not None), None)


def _is_method(node: ast.stmt) -> bool:
    if not isinstance(node, ast.FunctionDef):
        return False
    return not any(word in ast.unparse(mark) for mark in node.decorator_list for word in _PROPERTIES)


def _bound(owner: str, node: ast.stmt) -> Bound:
    assert isinstance(node, ast.FunctionDef)
    static = any(ast.unparse(mark) == "staticmethod" for mark in node.decorator_list)
    arguments = node.args.args[0 if not owner or static else 1 :]
    parameters = tuple((item.arg, _annotation(item)) for item in arguments)
    return Bound(owner, node.name, parameters, ast.unparse(node.returns) if node.returns else "")


def _annotation(item: ast.arg) -> str:
    """The type of a parameter, without the module that it is of."""
    return re.sub(r"\bslipwise\._core\.", "", ast.unparse(item.annotation or ast.Constant("")))

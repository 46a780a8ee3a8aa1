# SPDX-License-Identifier: Apache-2.0
"""Keys of a settings file, each declared once: name, default, what it does.

A field of a table that `key` declares is a key of users: docs/settings.md shows it, a settings file and
`--set` take it. Any other field is a constant of slipwise that benchmarks and tests vary from Python.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel, Field
from pydantic.fields import FieldInfo

_EXAMPLE = "example"


class Key(NamedTuple):
    """A key, as a settings file has it."""

    table: str  # "" above all tables
    name: str
    default: Any
    example: str  # TOML, where the default is none
    help: str

    @property
    def path(self) -> str:
        """The key with its table, as `--set` takes it."""
        return f"{self.table}.{self.name}".strip(".")


def key(default: Any, text: str, *, example: str = "", **bounds: Any) -> Any:
    """Return a field that users may set.

    Args:
        default: its value where nobody sets it; None needs an `example`.
        text: one line for docs/settings.md.
        example: a value as TOML has it.
        bounds: as pydantic's Field takes them.
    """
    return Field(default, description=text, json_schema_extra={_EXAMPLE: example}, **bounds)


def keys_of(model: type[BaseModel], table: str = "") -> Iterator[Key]:
    """Yield the keys of a table and of the tables in it."""
    for name, about in model.model_fields.items():
        inner = about.annotation
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            yield from keys_of(inner, f"{table}.{name}".strip("."))
        elif about.description is not None:
            yield Key(table, name, about.get_default(), _example(about), about.description)


def _example(about: FieldInfo) -> str:
    extra = about.json_schema_extra
    return str(extra.get(_EXAMPLE, "")) if isinstance(extra, dict) else ""


def changed_or_key(
    content: Mapping[str, Any], default: Mapping[str, Any], keys: set[str], table: str = ""
) -> dict[str, Any]:
    """Return nested tables without constants that are as they are by default."""
    found: dict[str, Any] = {}
    for name, value in content.items():
        path, before = f"{table}.{name}".strip("."), default.get(name)
        if isinstance(value, dict) and path not in keys and isinstance(before, dict):
            inner = changed_or_key(value, before, keys, path)
            found |= {name: inner} if inner else {}
        elif path in keys or value != before:
            found[name] = value
    return found

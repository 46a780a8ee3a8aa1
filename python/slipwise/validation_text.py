# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a checked document, in slipwise's own words rather than the checking library's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import ValidationError

_LONGEST = 40  # characters of a wrong value that are shown

_WORDS = {
    "missing": "is missing",
    "extra_forbidden": "there is no such key",
    "finite_number": "must be a finite number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be text",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
    "greater_than": "must be more than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "too_short": "needs at least {min_length} entries",
    "too_long": "takes at most {max_length} entries",
    "string_too_short": "needs at least {min_length} characters",
    "string_too_long": "takes at most {max_length} characters",
    "literal_error": "must be {expected}",
    "enum": "must be {expected}",
}
_KINDS = {
    "float": "must be a number",
    "int": "must be a whole number",
    "dict": "must be a table of keys",
    "mapping": "must be a table of keys",
    "model": "must be a table of keys",
    "path": "must be the path of a file",
}
_WITHOUT_VALUE = ("missing", "extra_forbidden", "too_short", "too_long")


def first_problem(error: ValidationError) -> str:
    """Return the key of the first problem and what is wrong with it, on one line."""
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    what = _what(str(first["type"]), first.get("ctx") or {})
    given = "" if first["type"] in (*_WITHOUT_VALUE, "value_error") else _shown(first.get("input"))
    return f"{key}: {what}{given}" if key else f"{what}{given}"


def _what(kind: str, context: Mapping[str, Any]) -> str:
    if kind == "value_error":
        return str(context["error"])
    if kind in _WORDS:
        return _WORDS[kind].format_map({name: _plain(value) for name, value in context.items()})
    return _KINDS.get(kind.partition("_")[0], "is not valid")


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _shown(value: Any) -> str:
    """Return a wrong value, shortened; nothing for what is long by nature."""
    if not isinstance(value, (bool, int, float, str)):
        return ""
    text = repr(value)
    return f", not {text if len(text) <= _LONGEST else text[:_LONGEST] + '...'}"

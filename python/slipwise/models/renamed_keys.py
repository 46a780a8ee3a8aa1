# SPDX-License-Identifier: Apache-2.0
"""Documents of older versions under the names that their keys have now."""

from __future__ import annotations

from collections.abc import Mapping

#: Names since, by the older ones, by where these stand; a `*` stands for any key or place in a list.
RenamedKeys = Mapping[str, Mapping[str, str]]


def with_new_keys(content: object, renamed: RenamedKeys, place: str = "") -> object:
    """Return `content` with every older key replaced; all else stays as it is.

    Args:
        content: dictionaries, lists and values, such as a YAML or TOML file gives.
        renamed: the new names of keys, by the old place of their dictionary.
        place: where `content` stands in the document, its keys joined by dots.
    """
    if isinstance(content, dict):
        names = _at(place, renamed)
        return {
            names.get(str(key), key): with_new_keys(value, renamed, _below(place, key))
            for key, value in content.items()
        }
    if isinstance(content, list):
        return [with_new_keys(value, renamed, _below(place, "*")) for value in content]
    return content


def matches(place: str, pattern: str) -> bool:
    """Return whether a pattern such as `parameters.*.name` is of this place."""
    parts, wanted = place.split("."), pattern.split(".")
    return len(parts) == len(wanted) and all(b in ("*", a) for a, b in zip(parts, wanted, strict=True))


def _below(place: str, key: object) -> str:
    return f"{place}.{key}" if place else str(key)


def _at(place: str, renamed: RenamedKeys) -> Mapping[str, str]:
    """The names for the dictionary at a place: those of every pattern that is of it."""
    found: dict[str, str] = {}
    for pattern, names in renamed.items():
        if matches(place, pattern):
            found |= names
    return found

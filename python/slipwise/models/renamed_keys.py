# SPDX-License-Identifier: Apache-2.0
"""Documents of older versions under the names that their keys have now."""

from __future__ import annotations

from collections.abc import Mapping

#: Names since, by the older ones, by where these stand; a `*` stands for any key or place in a list.
RenamedKeys = Mapping[str, Mapping[str, str]]


def with_new_keys(content: object, renamed: RenamedKeys, place: tuple[str, ...] = ()) -> object:
    """Return `content` with every older key replaced; all else stays as it is.

    Args:
        content: dictionaries, lists and values, such as a YAML or TOML file gives.
        renamed: the new names of keys, by the old place of their dictionary: its keys joined by dots.
        place: the keys that lead to `content` in the document.
    """
    if isinstance(content, dict):
        names = _names_at(place, renamed)
        return {
            names.get(str(key), key): with_new_keys(value, renamed, (*place, str(key)))
            for key, value in content.items()
        }
    if isinstance(content, list):
        return [with_new_keys(value, renamed, (*place, "*")) for value in content]
    return content


def _names_at(place: tuple[str, ...], renamed: RenamedKeys) -> dict[str, str]:
    """The names for the dictionary at a place: those of every pattern that is of it."""
    found: dict[str, str] = {}
    for pattern, names in renamed.items():
        wanted = pattern.split(".") if pattern else []
        if len(wanted) == len(place) and all(b in ("*", a) for a, b in zip(place, wanted, strict=True)):
            found |= names
    return found

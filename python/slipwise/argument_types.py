# SPDX-License-Identifier: Apache-2.0
"""The one check of what public functions are given: what their annotations name, or an error says so."""

from __future__ import annotations

import os
import types
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from slipwise.errors import SettingsError
from slipwise.number_text import list_text

_WORDS = {
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    str: "text",
    bytes: "bytes",
    Path: "a path",
}
_NUMBERS = {float: ("__float__", "__index__"), int: ("__index__",)}  # kinds, and how they are converted
_LEFT = ("ArrayLike", "DTypeLike")  # to the functions
_LONGEST = 40  # characters of a value in a message


def check_arguments(function: Callable[..., object], given: Mapping[str, Any]) -> None:
    """Refuse what a function is given where it is of another kind than its annotations say.

    What is annotated as `ArrayLike` or `DTypeLike` is left to the function, which knows the shapes.

    Args:
        function: a function, a method, or a data class.
        given: the arguments by their names, as `locals()` has them at its beginning.

    Raises:
        SettingsError: an argument is of another kind.
    """
    for name, (hint, several) in _hints(function).items():
        for value in given[name] if several else (given[name],):
            if not _fits(value, hint):
                raise SettingsError(
                    f"{name} is {_shown(value)}",
                    where=f"{function.__qualname__.removesuffix('.__init__')}()",
                    advice=f"give {_words(hint)}",
                )


@lru_cache(maxsize=64)
def _hints(function: Callable[..., object]) -> dict[str, tuple[Any, bool]]:
    """Return by its name what an argument is to be, and whether it is any number of them."""
    hints = get_type_hints(function)
    return {
        name: (hints[name], parameter.kind is Parameter.VAR_POSITIONAL)
        for name, parameter in signature(function).parameters.items()
        if name in hints
        and parameter.kind is not Parameter.VAR_KEYWORD
        and not any(each in str(parameter.annotation) for each in _LEFT)
    }


def _fits(value: Any, hint: Any) -> bool:
    origin, inside = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, each) for each in inside)
    if hint in _NUMBERS:
        return _is_number(value, _NUMBERS[hint])
    if origin is tuple:  # which lists and arrays may stand for
        each = inside[:1] * np.size(value) if inside[-1] is ... else inside
        return np.ndim(value) == 1 and len(value) == len(each) and all(map(_fits, value, each))
    if origin is Sequence:
        return isinstance(value, Sequence) and all(_fits(each, inside[0]) for each in value)
    kind = os.PathLike if hint is Path else origin or hint
    return not isinstance(kind, type) or isinstance(value, kind)


def _is_number(value: Any, conversions: tuple[str, ...]) -> bool:
    is_flag = isinstance(value, bool | np.bool_)
    return not is_flag and np.ndim(value) == 0 and any(hasattr(type(value), each) for each in conversions)


def _shown(value: Any) -> str:
    text = repr(value)
    simple = value is None or isinstance(value, str | bytes | bool | int | float | list | tuple)
    return text if simple and len(text) <= _LONGEST else f"of type {type(value).__name__}"


def _words(hint: Any) -> str:
    origin, inside = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        words = [_words(each) for each in inside if not (each is str and Path in inside)]
        return list_text(words, "or")
    if origin is tuple:
        return "numbers" if inside[-1] is ... else f"{len(inside)} numbers"
    if origin is Sequence:
        return "a list"
    name = getattr(origin or hint, "__name__", str(hint))
    article = "an" if name[0] in "AEIOU" else "a"
    return _WORDS.get(hint, "None" if hint is type(None) else f"{article} {name}")

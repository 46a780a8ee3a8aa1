# SPDX-License-Identifier: Apache-2.0
"""Reading YAML that came from anywhere: plain data of a sane size, without aliases, tags or doubled keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from slipwise.errors import ModelError, SlipwiseError
from slipwise.files import read_whole

MAX_BYTES = 4 * 1024 * 1024
MAX_DIGITS = 64  # of one number; nothing physical has more
MAX_DEPTH = 100  # of lists and mappings in each other

_SafeLoader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the same data, several times faster in C


def _refuse_odd(data: bytes | str) -> None:
    """Refuse aliases, explicit tags and what is nested without end before anything is made of them."""
    depth = 0
    for event in yaml.parse(data, Loader=_SafeLoader):
        mark: Any = event.start_mark
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        tag = getattr(event, "tag", None)
        problem = "aliases are not allowed" if isinstance(event, yaml.AliasEvent) else ""
        problem = problem or (f"the tag {tag} is not allowed" if tag is not None else "")
        problem = problem or ("it is nested too deep" if depth > MAX_DEPTH else "")
        if problem:
            raise yaml.constructor.ConstructorError(None, None, problem, mark)


class _PlainLoader(_SafeLoader):  # type: ignore[misc]
    """SafeLoader that also refuses doubled keys and endless numbers."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        entries = len(node.value)
        if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
            raise yaml.constructor.ConstructorError(None, None, "merges are not allowed", node.start_mark)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        if len(mapping) != entries:
            raise yaml.constructor.ConstructorError(None, None, "a key stands twice", node.start_mark)
        return mapping

    def construct_number(self, node: yaml.ScalarNode) -> int | float:
        if len(node.value) > MAX_DIGITS:
            raise yaml.constructor.ConstructorError(None, None, "a number is too long", node.start_mark)
        if node.tag.endswith(":int"):
            return int(self.construct_yaml_int(node))
        return float(self.construct_yaml_float(node))


_PlainLoader.add_constructor("tag:yaml.org,2002:int", _PlainLoader.construct_number)
_PlainLoader.add_constructor("tag:yaml.org,2002:float", _PlainLoader.construct_number)


def read_yaml(path: Path, *, error: type[SlipwiseError] = ModelError) -> dict[str, Any]:
    """Return the mapping in the YAML file `path`.

    Raises:
        SlipwiseError: of type `error`: the file is missing, too large, not plain YAML or not a mapping.
    """
    return parse_yaml(read_whole(path, most=MAX_BYTES, error=error), where=str(path), error=error)


def parse_yaml(data: bytes | str, *, where: str, error: type[SlipwiseError] = ModelError) -> dict[str, Any]:
    """Return the mapping in YAML text that came from `where`.

    Raises:
        SlipwiseError: of type `error`: the text is too large, not plain YAML or not a mapping.
    """
    if len(data) > MAX_BYTES:
        raise error("the text is too long", where=where, advice="is it a slipwise file?")
    try:
        _refuse_odd(data)
        content = yaml.load(data, Loader=_PlainLoader)  # noqa: S506 - a SafeLoader with more refusals
    except (yaml.YAMLError, ValueError, RecursionError) as problem:
        mark = getattr(problem, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark is not None else ""
        what = getattr(problem, "problem", None) or str(problem).splitlines()[0]
        raise error(
            f"not a plain YAML file: {what}", where=f"{where}{line}", advice="write plain keys and values"
        ) from problem
    if not isinstance(content, dict):
        raise error("the file holds no keys", where=where, advice="write `key: value` lines")
    return content

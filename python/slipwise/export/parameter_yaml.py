# SPDX-License-Identifier: Apache-2.0
"""A ROS parameter file of a user, edited in its text: what is not changed stays to the byte, comments too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from slipwise.errors import SettingsError
from slipwise.export.origin import one_line
from slipwise.export.parameter_file import Value, yaml_value

_PARAMETERS = "ros__parameters"
LONG = 6  # a list of more numbers is shown without its zeros


@dataclass(frozen=True)
class NodeParameters:
    """The parameters of one ROS node: its full name, and where they stand."""

    name: str
    mapping: MappingNode

    def find(self, name: str) -> Node | None:
        """Return the value of a parameter, whether its name is nested or written with dots."""
        return _find(self.mapping, tuple(name.split(".")))

    def plugins(self) -> dict[str, str]:
        """Return what the plug-ins of the node are, by the names that the user gave them."""
        found = {}
        for key, value in self.mapping.value:
            kind = _find(value, ("plugin",)) if isinstance(value, MappingNode) else None
            if isinstance(kind, ScalarNode):
                found[key.value] = kind.value
        return found


class ParameterYaml:
    """The text of a parameter file.

    Raises:
        SettingsError: it is no YAML of nodes with `ros__parameters`.
    """

    def __init__(self, text: str, where: str) -> None:
        self.text, self.where = text, where
        try:
            self._root = yaml.compose(text, Loader=yaml.SafeLoader)
        except yaml.YAMLError as problem:
            raise SettingsError(
                f"it is no YAML: {one_line(str(problem))}", where=where, advice="give a ROS parameter file"
            ) from None
        self.nodes = list(_nodes(self._root, ()))
        if not self.nodes:
            raise SettingsError(
                f"no node in it has {_PARAMETERS}", where=where, advice="give a ROS parameter file"
            )
        self._edits: list[_Edit] = []

    def old(self, node: Node) -> str:
        """Return a value as it is written, on one line; of a long list what is not zero."""
        if isinstance(node, SequenceNode):
            if len(node.value) > LONG:
                return " ".join(self.old(item) for item in node.value if not same(item, 0.0))
            return f"[{', '.join(map(self.old, node.value))}]"
        return " ".join(self.text[node.start_mark.index : node.end_mark.index].split())

    def replace(self, node: Node, value: Value) -> str:
        """Have a value replaced; return why not, where it cannot be."""
        old = self.text[node.start_mark.index : node.end_mark.index]
        if "$(" in old:
            return "a launch file puts its value in"
        if self._is_shared(node):
            return "other values are written by its anchor"
        if isinstance(node, SequenceNode) and isinstance(value, list):
            numbers: Sequence[Value] = value
            if len(node.value) != len(numbers):
                return f"it has {len(node.value)} numbers in the file, and {len(numbers)} are to be written"
            self._edits += [
                _Edit(item.start_mark.index, item.end_mark.index, yaml_value(new))
                for item, new in zip(node.value, numbers, strict=True)
                if not same(item, new)
            ]
            return ""
        if not isinstance(node, ScalarNode) or isinstance(value, list) or node.style in ("|", ">"):
            return "the file has something else by its name"
        self._edits.append(_Edit(node.start_mark.index, node.end_mark.index, yaml_value(value)))
        return ""

    def insert(self, node: NodeParameters, name: str, value: Value, meaning: str) -> str:
        """Have a parameter added to a node, with a comment; return why not, where it cannot be."""
        mapping, parts = node.mapping, tuple(name.split("."))
        while len(parts) > 1:
            inner = _find(mapping, parts[:1])
            if not isinstance(inner, MappingNode):
                break
            mapping, parts = inner, parts[1:]
        if mapping.flow_style or not mapping.value or self._is_shared(mapping):
            return "its place in the file is not a block of lines: write it by hand"
        indent = " " * mapping.start_mark.column
        line = self._line_after(mapping)
        end = "\r\n" if "\r\n" in self.text else "\n"
        lines = [f"{indent}# {one_line(meaning)}", f"{indent}{'.'.join(parts)}: {yaml_value(value)}"]
        added = "".join(f"{each}{end}" for each in lines)
        self._edits.append(_Edit(line, line, added if self.text[line - 1 : line] == "\n" else end + added))
        return ""

    def edited(self) -> str:
        """Return the text with all that was replaced and added."""
        parts, end = [], 0
        for edit in sorted(self._edits, key=lambda each: each.start):
            parts += [self.text[end : edit.start], edit.new]
            end = edit.end
        return "".join([*parts, self.text[end:]])

    def _line_after(self, node: Node) -> int:
        """Return where the line after a value's last one begins."""
        last = node
        while isinstance(last, (MappingNode, SequenceNode)) and not last.flow_style and last.value:
            last = last.value[-1][1] if isinstance(last, MappingNode) else last.value[-1]
        end = last.end_mark.index
        if self.text[end - 1 : end] == "\n":
            return end
        following = self.text.find("\n", end)
        return len(self.text) if following < 0 else following + 1

    def _is_shared(self, node: Node) -> bool:
        """Whether the file refers to the value from another place: it then stands there, or has an anchor."""
        return sum(each is node for each in _walk(self._root)) > 1


def same(node: Node, value: Value) -> bool:
    """Whether a value of a file is what is to be written, numbers to six digits."""
    if isinstance(value, list):
        items = node.value if isinstance(node, SequenceNode) else []
        numbers: Sequence[Value] = value
        return len(items) == len(numbers) and all(map(same, items, numbers))
    if not isinstance(node, ScalarNode):
        return False
    there = yaml.safe_load(node.value) if node.style is None and node.value else node.value
    if isinstance(value, (bool, str)) or isinstance(there, bool):
        return bool(there == value)
    try:
        return f"{float(node.value):.6g}" == f"{value:.6g}"
    except ValueError:
        return False


@dataclass(frozen=True)
class _Edit:
    start: int
    end: int
    new: str = field(repr=False)


def _nodes(node: Node | None, path: tuple[str, ...]) -> Iterator[NodeParameters]:
    """Find the nodes, by names or nested in namespaces."""
    if not isinstance(node, MappingNode):
        return
    for key, value in node.value:
        if key.value == _PARAMETERS:
            if isinstance(value, MappingNode):
                yield NodeParameters("/".join(path).replace("//", "/"), value)
        else:
            yield from _nodes(value, (*path, str(key.value)))


def _find(node: Node, parts: Sequence[str]) -> Node | None:
    if not parts:
        return node
    if not isinstance(node, MappingNode):
        return None
    for count in range(1, len(parts) + 1):
        name = ".".join(parts[:count])
        for key, value in node.value:
            if key.value == name and (found := _find(value, parts[count:])) is not None:
                return found
    return None


def _walk(node: Node | None) -> Iterator[Node]:
    if node is not None:
        yield node
    if isinstance(node, MappingNode):
        for _, value in node.value:
            yield from _walk(value)
    elif isinstance(node, SequenceNode):
        for item in node.value:
            yield from _walk(item)

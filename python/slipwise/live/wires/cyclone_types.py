# SPDX-License-Identifier: Apache-2.0
"""ROS message types as Cyclone DDS wants them: classes, made at run time from what rosbags knows."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

from slipwise.live.wires.ros_types import require_type, ros_types

#: A struct needs a member; ROS gives this one to an empty message.
_EMPTY = "structure_needs_at_least_one_member"


@cache
def cyclone_type(type_name: str, *, numbered: bool = False) -> Any:
    """Return the class of a message: final, members numbered in their order, as ROS has them.

    Only its description is used; messages stay bytes.

    Args:
        type_name: such as "nav_msgs/msg/Odometry".
        numbered: begin with who asks and the number of the request, as services of rmw_cyclonedds do.

    Raises:
        SettingsError: there is no such type.
    """
    from cyclonedds.idl import annotations, make_idl_struct, types

    fields = ros_types().fielddefs[require_type(type_name)][1]
    members = {"client": types.uint64, "number": types.int64} if numbered else {}
    members.update({name: _member_type(description) for name, description in fields})
    package, kind, name = type_name.split("/")
    made = make_idl_struct(f"{name}_", f"{package}.{kind}.dds_.{name}_", members or {_EMPTY: types.uint8})
    return annotations.final(annotations.autoid("sequential")(made))


def _member_type(description: Any) -> Any:
    from rosbags.interfaces import Nodetype

    types: Any = import_module("cyclonedds.idl.types")

    kind, content = description
    if kind == Nodetype.BASE:
        return _simple_type(*content)
    if kind == Nodetype.NAME:
        return cyclone_type(content)
    element, length = content
    if kind == Nodetype.ARRAY:
        return types.array[_member_type(element), length]
    return types.sequence[_member_type(element), length] if length else types.sequence[_member_type(element)]


def _simple_type(name: str, longest: int) -> Any:
    types: Any = import_module("cyclonedds.idl.types")

    if name == "string":
        return types.bounded_str[longest] if longest else str
    if name == "bool":
        return bool
    return getattr(types, "uint8" if name in ("byte", "char") else name)

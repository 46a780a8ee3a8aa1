# SPDX-License-Identifier: Apache-2.0
"""The ROS messages and services that the wires know: names on the wire, hashes, bytes."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from slipwise.errors import SettingsError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

#: What rosbags does not bring: services, by the fields of request and response.
_SERVICES: dict[str, tuple[dict[str, str], dict[str, str]]] = {
    "rcl_interfaces/srv/DescribeParameters": (
        {"names": "string[]"},
        {"descriptors": "rcl_interfaces/msg/ParameterDescriptor[]"},
    ),
    "rcl_interfaces/srv/SetParametersAtomically": (
        {"parameters": "rcl_interfaces/msg/Parameter[]"},
        {"result": "rcl_interfaces/msg/SetParametersResult"},
    ),
    "rcl_interfaces/srv/SetParameters": (
        {"parameters": "rcl_interfaces/msg/Parameter[]"},
        {"results": "rcl_interfaces/msg/SetParametersResult[]"},
    ),
    "std_srvs/srv/Trigger": ({}, {"success": "bool", "message": "string"}),
}
OWN_PACKAGE = "slipwise_msgs"
_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"


@cache
def ros_types() -> Typestore:
    """Return the message types of ROS 2 Jazzy, with the services that the wires call.

    A service is there as its request, its response (`..._Request`, `..._Response`), and as the type of which
    the hash of the service is made.
    """
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    # ROS turns its characters into uint8 before it makes hashes, rosbags does not.
    store.fielddefs.pop(_EVENT_INFO, None)
    structs: dict[str, dict[str, str]] = {
        _EVENT_INFO: {
            "event_type": "uint8",
            "stamp": "builtin_interfaces/msg/Time",
            "client_gid": "uint8[16]",
            "sequence_number": "int64",
        }
    }
    for name, (request, response) in _SERVICES.items():
        structs[f"{name}_Request"] = request
        structs[f"{name}_Response"] = response
        structs[f"{name}_Event"] = {
            "info": _EVENT_INFO,
            "request": f"{name}_Request[<=1]",
            "response": f"{name}_Response[<=1]",
        }
        structs[name] = {
            "request_message": f"{name}_Request",
            "response_message": f"{name}_Response",
            "event_message": f"{name}_Event",
        }
    missing = {name: fields for name, fields in structs.items() if name not in store.fielddefs}
    store.register(
        {
            name: ([], [(field, _field(text)) for field, text in fields.items()])
            for name, fields in missing.items()
        }
    )
    store.register(_own_types())
    return store


def _own_types() -> dict[str, Any]:
    """Return the messages of slipwise's own, whose files are those of the ROS package slipwise_msgs."""
    from rosbags.typesys import get_types_from_msg

    found: dict[str, Any] = {}
    for file in files("slipwise.live").joinpath("messages").iterdir():
        text = file.read_text(encoding="utf-8")
        found |= get_types_from_msg(text, f"{OWN_PACKAGE}/msg/{file.name.removesuffix('.msg')}")
    return found


def _field(text: str) -> Any:
    """Return rosbags' description of a field such as "uint8[16]", "pkg/msg/Type[]", "pkg/msg/Type[<=1]"."""
    from rosbags.interfaces import Nodetype

    name, bracket, length = text.removesuffix("]").partition("[")
    element = (Nodetype.NAME, name) if "/" in name else (Nodetype.BASE, (name, 0))
    if not bracket:
        return element
    if length.isdigit():
        return Nodetype.ARRAY, (element, int(length))
    return Nodetype.SEQUENCE, (element, int(length.removeprefix("<=") or 0))


def require_type(type_name: str) -> str:
    """Return the name of a type, which has to be known.

    Raises:
        SettingsError: it is not.
    """
    if type_name not in ros_types().fielddefs:
        raise SettingsError(
            f'there is no message type "{type_name}"',
            advice='a type is named like "nav_msgs/msg/Odometry"; those of ROS 2 Jazzy are known',
        )
    return type_name


def dds_type(type_name: str) -> str:
    """Return a type's name on the wire: "nav_msgs/msg/Odometry" is "nav_msgs::msg::dds_::Odometry_"."""
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_type(dds_name: str) -> str:
    """Return the ROS name of a type on the wire; other names are returned as they are."""
    return (
        dds_name.removesuffix("_").replace("::dds_::", "/").replace("::", "/")
        if "::dds_::" in dds_name
        else dds_name
    )


@cache
def type_hash(type_name: str) -> str:
    """Return the hash of a type by REP-2016, "RIHS01_" and 64 digits."""
    return ros_types().hash_rihs01(require_type(type_name))

# SPDX-License-Identifier: Apache-2.0
"""ROS parameters of the live node: the settings, options and their help, as slipwise declares them once."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from slipwise.calibration import Settings
from slipwise.calibration.keys import keys_of
from slipwise.cli.live import live
from slipwise.cli.live_parts import live_settings, with_memory
from slipwise.cli.options import chosen_settings, log_options
from slipwise.log_fields import LOG_FIELDS, About, Kind
from slipwise.logs import LogOptions

#: Options of `slipwise live` that are parameters, by what its signature calls them.
OPTIONS = {
    "name": "name",
    "input": "input_name",
    "model": "model",
    "memory": "memory",
    "surface": "surface",
    "cache": "cache",
    "settings": "settings",
}
#: Keys that ROS answers itself, or that a parameter cannot hold.
NOT_HERE = ("log.", "live.node", "live.network", "live.address", "pose_sources")
AUTOSTART = "autostart"


@dataclass(frozen=True)
class Declared:
    """A parameter; where its default is None, it is not set, and of any type."""

    name: str
    default: Any
    help: str
    example: str = ""


def declared() -> Iterator[Declared]:
    """Yield every parameter that is read when the node is configured."""
    options = inspect.signature(live).parameters
    for name, option in OPTIONS.items():
        (about,) = options[option].annotation.__metadata__
        default = options[option].default
        yield Declared(name, default if isinstance(default, bool) else None, about.help)
    for field in LOG_FIELDS:
        if field.kind is not Kind.files:
            yield Declared(field.name, None, field.help, field.example)
    for key in keys_of(Settings):
        if not key.path.startswith(NOT_HERE):
            fixed = key.default is not None and key.default not in ([], {})
            default = json.dumps(key.default) if not fixed and key.default is not None else key.example
            yield Declared(key.path, key.default if fixed else None, key.help, default)


def declare(node: Node) -> None:
    """Declare all of them on a node, with descriptors."""
    for each in declared():
        about = ParameterDescriptor(
            description=each.help,
            dynamic_typing=each.default is None or isinstance(each.default, str),  # to YAML, off is no text
            additional_constraints=f"such as {each.example}" if each.example else "",
        )
        node.declare_parameter(each.name, each.default, about)
    about = ParameterDescriptor(description="configure and activate the node when it starts", read_only=True)
    node.declare_parameter(AUTOSTART, False, about)


def chosen(node: Node) -> tuple[Settings, LogOptions]:
    """Return what the parameters say.

    Raises:
        SlipwiseError: a value is wrong.
    """
    values = {each.name: _declared(each, node.get_parameter(each.name).value) for each in declared()}
    given = {name: value for name, value in values.items() if value is not None and value != ""}
    file = Path(given.pop("settings")) if "settings" in given else None
    keys = {key.path: key.default for key in keys_of(Settings)}
    changes = [f"{name}={_toml(given[name])}" for name in keys if name in given and given[name] != keys[name]]
    settings = chosen_settings(file, changes)
    own = {name: given[name] for name in OPTIONS if name in given} | {"node": node.get_name()}
    settings = with_memory(live_settings(settings, own))
    logged = {field.name: _option(node, field, given.get(field.name)) for field in LOG_FIELDS}
    return settings, log_options(logged, file, changes)


def _declared(each: Declared, value: Any) -> Any:
    """Return a value as it was meant: `live.apply.mode:=off` reaches ROS as false, by the rules of YAML."""
    if isinstance(value, bool) and isinstance(each.default, str):
        return "on" if value else "off"
    return value


def _toml(value: Any) -> str:
    """Return a value as `--set` takes it; a text stays as it is, which may be TOML itself."""
    return value if isinstance(value, str) else json.dumps(value)


def _option(node: Node, field: About, value: Any) -> Any:
    """Return a value as the command line gives it; names of topics as ROS resolves them here."""
    if value is None:
        return None
    resolve = node.resolve_topic_name if field.name.endswith("_topic") else _same
    if field.kind is Kind.topics:
        return [_resolved(each, resolve) for each in ([value] if isinstance(value, str) else value)]
    if field.kind in (Kind.positive, Kind.number):
        return float(value)
    return _resolved(",".join(map(str, value)) if isinstance(value, list | tuple) else str(value), resolve)


def _same(name: str) -> str:
    return name


def _resolved(name: str, resolve: Callable[[str], str]) -> str:
    return name if name == "none" else resolve(name)

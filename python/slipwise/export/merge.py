# SPDX-License-Identifier: Apache-2.0
"""A model's numbers in the parameter file that a robot runs with: what changes, from what, and why."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from yaml.nodes import ScalarNode

from slipwise.errors import ModelError, SettingsError
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, ParameterFile, Value, yaml_value
from slipwise.export.parameter_yaml import LONG, NodeParameters, ParameterYaml, same

_MPPI, _MPPI_PLUGIN = "FollowPath", "nav2_mppi_controller::MPPIController"
_FILTER = "ekf_filter_node"
_CONTROLLER_TYPE = "diff_drive_controller/DiffDriveController"
_MULTIPLIERS = {
    "wheel_separation_multiplier": "logged_separation_multiplier",
    "left_wheel_radius_multiplier": "logged_radius_multiplier",
    "right_wheel_radius_multiplier": "logged_radius_multiplier",
}


@dataclass(frozen=True)
class Change:
    """One parameter of a file: what it was, or nothing, what it becomes, and why."""

    name: str
    old: str
    new: str
    why: str


@dataclass(frozen=True)
class Merged:
    """A user's file with a model's numbers."""

    text: str
    changes: tuple[Change, ...] = ()
    kept: Mapping[str, str] = field(default_factory=dict)  # what is not written, and why


def options_of(text: str, where: str, options: ExportOptions) -> ExportOptions:
    """Return the options with what the file itself says: how far MPPI plans, how often others run.

    Raises:
        SettingsError: the file is no ROS parameter file.
    """
    file = ParameterYaml(text, where)
    for node in file.nodes:
        name = node.name.rsplit("/", 1)[-1]
        if name == "controller_manager" and options.update_rate is None:
            options = replace(options, update_rate=_number(node, "update_rate"))
        rate = _number(node, "frequency") if node.find("odom0") or name == _FILTER else None
        if rate and options.filter_rate == _RATE:
            options = replace(options, filter_rate=rate)
        for plugin, kind in node.plugins().items():
            steps, period = _number(node, f"{plugin}.time_steps"), _number(node, f"{plugin}.model_dt")
            if kind == _MPPI_PLUGIN and steps and period and options.planning_horizon == _HORIZON:
                options = replace(options, planning_horizon=steps * period)
    return options


_HORIZON, _RATE = ExportOptions().planning_horizon, ExportOptions().filter_rate


def merge_parameters(text: str, where: str, made: ParameterFile, options: ExportOptions) -> Merged:
    """Return a ROS parameter file with the values of `made`; everything else stays as it is.

    Args:
        text: of the user's file.
        where: its name, for errors.
        made: the values of one node.
        options: with which they were made.

    Raises:
        SettingsError: the file is no parameter file, or has no such node or several.
        ModelError: the file is set up for something else than the values suppose.
    """
    file = ParameterYaml(text, where)
    node = _node_of(file, made)
    names = _own_names(file, node, made)
    _refuse_other_setup(file, node, made, names)
    entries = [entry for entry in made.entries if isinstance(entry, Entry)]
    changes = [
        change
        for entry in entries
        if not entry.supposed and (change := _change(file, node, names(entry.name), entry, options))
    ]
    if changes:  # what they suppose is the tool's default, or is said
        absent = [entry for entry in entries if entry.supposed and node.find(names(entry.name)) is None]
        changes += filter(None, (_change(file, node, names(each.name), each, options) for each in absent))
    kept = {names(name): why for name, why in made.kept().items()}
    return Merged(file.edited(), tuple(changes), kept)


def _change(
    file: ParameterYaml, node: NodeParameters, name: str, entry: Entry, options: ExportOptions
) -> Change | None:
    """Have a value written; return what changes.

    Raises:
        ModelError: it cannot be written as it must be, so that the others would be wrong beside it.
    """
    found, why = node.find(name), " ".join(entry.meaning.split())
    if found is not None and same(found, entry.value):
        return None
    old = "" if found is None else file.old(found)
    refused = _in_force(name, found, options) or (
        file.insert(node, name, entry.value, why) if found is None else file.replace(found, entry.value)
    )
    if refused:
        raise ModelError(f"{name} cannot be written: {refused}", where=file.where, advice=_BY_HAND)
    return Change(name, old, _short(entry.value), why)


_BY_HAND = "mend that first, or export without --merge and take what you need"


def merge_firmware(text: str, where: str, made: str, kept: Mapping[str, str]) -> Merged:
    """Return an autopilot's parameter file with the values of `made`, line by line.

    Raises:
        SettingsError: the file has no line of a parameter.
    """
    found = {match["name"]: match for match in _LINE.finditer(text)}
    if not found:
        raise SettingsError("no line of it is a parameter", where=where, advice="give NAME,VALUE lines")
    changes, left, meaning = [], dict(kept), ""
    for line in made.splitlines():
        new = _LINE.fullmatch(line)
        if new is None:
            meaning = line.lstrip("# ") or meaning
        elif new["name"] not in found:
            left[new["name"]] = "the file does not have it"
        elif float(found[new["name"]]["value"]) != float(new["value"]):
            changes.append(Change(new["name"], found[new["name"]]["value"], new["value"], meaning))
    for change in sorted(changes, key=lambda each: found[each.name].start("value"), reverse=True):
        start, end = found[change.name].span("value")
        text = text[:start] + change.new + text[end:]
    return Merged(text, tuple(changes), left)


_LINE = re.compile(
    r"^(?:\d+\s+\d+\s+)?(?P<name>[A-Z][A-Z0-9_]+)(?:\s*,\s*|[ \t]+)(?P<value>[-+0-9.eE]+)[^\n]*$",
    re.MULTILINE,
)


def _node_of(file: ParameterYaml, made: ParameterFile) -> NodeParameters:
    """Find the node by its name, by what it is, or as the only one that has such parameters."""
    names = {made.node.strip("/")}
    if made.node == "diff_drive_controller":
        names |= {
            name
            for node in file.nodes
            for name in (str(key.value) for key, _ in node.mapping.value)
            if isinstance(kind := node.find(f"{name}.type"), ScalarNode) and kind.value == _CONTROLLER_TYPE
        }
    wanted = [entry.name for entry in made.entries if isinstance(entry, Entry)]
    having = [node for node in file.nodes if any(node.find(name) is not None for name in wanted)]
    found = [node for node in file.nodes if node.name.rsplit("/", 1)[-1] in names - {"**"}] or having
    if len(found) == 1:
        return found[0]
    there = ", ".join(node.name for node in found or file.nodes)
    raise SettingsError(
        f"{'several nodes' if found else 'no node'} in it could be {made.node} ({there})",
        where=file.where,
        advice="give a file of one robot" if found else "give the file that has its parameters",
    )


class _Names:
    """Names of parameters as a file has them: a plug-in has the name that its user gave it."""

    def __init__(self, ours: str = "", theirs: str = "") -> None:
        self._ours, self._theirs = ours, theirs

    def __call__(self, name: str) -> str:
        own = self._ours and name.startswith(f"{self._ours}.")
        return self._theirs + name[len(self._ours) :] if own else name


def _own_names(file: ParameterYaml, node: NodeParameters, made: ParameterFile) -> _Names:
    if not any(entry.key[0] == _MPPI for entry in made.entries):
        return _Names()
    controllers = [name for name, kind in node.plugins().items() if kind == _MPPI_PLUGIN]
    if len(controllers) != 1:
        raise SettingsError(
            f"{node.name} has {len(controllers)} MPPI controllers",
            where=file.where,
            advice=f"give a file in which one plug-in is {_MPPI_PLUGIN}",
        )
    return _Names(_MPPI, controllers[0])


def _refuse_other_setup(
    file: ParameterYaml, node: NodeParameters, made: ParameterFile, names: _Names
) -> None:
    """Refuse where the numbers suppose something else than the file says."""
    for entry in made.entries:
        if not isinstance(entry, Entry) or not entry.supposed:
            continue
        found = node.find(names(entry.name))
        if found is not None and not same(found, entry.value):
            raise ModelError(
                f"the numbers are for {names(entry.name)} = {_short(entry.value)}, and {file.where} has"
                f" {file.old(found)}: nothing is merged",
                advice="set it there first, or export with options that fit it",
            )


def _in_force(name: str, found: object, options: ExportOptions) -> str:
    """Say why a factor of the wheels is not written: the log was recorded with another than the file's."""
    option = _MULTIPLIERS.get(name)
    if option is None:
        return ""
    there = float(found.value) if isinstance(found, ScalarNode) else 1.0
    given = getattr(options, option)
    if abs(there / given - 1.0) < _SAME_FACTOR:
        return ""
    return (
        f"the file has {there:g}, and the log was recorded with {given:g} as far as is said:"
        f" --{option.replace('_', '-')}"
    )


_SAME_FACTOR = 1e-6


def _number(node: NodeParameters, name: str) -> float | None:
    found = node.find(name)
    try:
        return float(found.value) if isinstance(found, ScalarNode) else None
    except ValueError:
        return None


def _short(value: Value) -> str:
    """Return a value for a table; of a long list what is not zero."""
    if isinstance(value, list) and len(value) > LONG:
        return " ".join(yaml_value(item) for item in value if item)
    return yaml_value(value)

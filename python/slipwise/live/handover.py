# SPDX-License-Identifier: Apache-2.0
"""Hands an applied model on: files for other tools, and parameters that running nodes may take."""

from __future__ import annotations

import os
from pathlib import Path

from slipwise.calibration.live_table import TARGET_NODES, ApplyTable
from slipwise.errors import SlipwiseError
from slipwise.export import ExportOptions, export_model, find_target
from slipwise.export.parameter_file import Value
from slipwise.export.ros_tables import TABLES, RosParameter
from slipwise.files import write_text_whole
from slipwise.live.outputs import AppliedParameters
from slipwise.live.said import Said
from slipwise.models import Model

_MODEL = "model.yaml"
_OUR_ODOMETRY = "until then the odometry of slipwise (~/odometry, ~/twist) has what was learned"


class Handover:
    """Writes what is asked for; what cannot be written or does not fit is said once, and the rest goes on.

    Limits of speeds and accelerations are never among it, and a running node gets only what it takes
    while it runs.

    Args:
        rules: what is handed on, and where to.
        said: where news are said.
    """

    def __init__(self, rules: ApplyTable, said: Said) -> None:
        self._rules, self._said = rules, said
        self._reached: set[str] = set()  # targets that got something
        self._sent: set[tuple[str, str]] = set()  # targets and names of parameters that nodes got
        self._options = ExportOptions(ros_distro=os.environ.get("ROS_DISTRO") or None)

    def withdraw(self, t: float, model: Model, why: str) -> list[AppliedParameters]:
        """Write the start values into the files, with a word why; return the parameters for running nodes.

        Args:
            t: now, a stamp [s].
            model: with the start values.
            why: what was handed on must not be used.
        """
        reason = " ".join(why.split())
        mark = f"# Withdrawn at stamp {t:.3f} s, these are the start values again: {reason}\n"
        again = self.hand_on(t, model, mark=mark)
        names = {(each.target, name) for each in again for name in each.values}
        left = sorted(f"{name} of {target}" for target, name in self._sent - names)
        if left:
            self._said.note(t, f"the start has no {', '.join(left)}: restart the nodes that got values")
        self._sent = names
        return again

    def hand_on(self, t: float, model: Model, *, mark: str = "") -> list[AppliedParameters]:
        """Write the files, each with a `mark` on top; return the parameters for running nodes."""
        if self._rules.folder is None and not (self._rules.set_parameters and self._rules.targets):
            self._said.begins(t, "nowhere", "no parameters are applied: [live.apply] folder is not set")
            return []
        written = [_MODEL] if self._write(t, _MODEL, mark + model.to_yaml()) else []
        wanted = []
        for target in self._rules.targets:
            try:
                made = export_model(model, target, name="the live model", options=self._options)
            except SlipwiseError as problem:
                self._said.begins(t, f"export {target}", f"{target} gets nothing: {problem}")
                if mark:  # what is there must not be used
                    self._write(t, find_target(target).file_name, mark)
                continue
            self._said.ends(t, f"export {target}")
            name = find_target(target).file_name
            if self._write(t, name, mark + made.text):
                written.append(name)
                self._reached.add(target)
            if self._rules.set_parameters:
                wanted += self._to_send(t, target, made.values)
        if written:
            what = "start values written to" if mark else "written to"
            self._said.note(t, f"{what} {self._rules.folder}: {', '.join(written)}")
        return wanted

    def finish(self, t: float) -> None:
        """Say which targets got nothing until the end."""
        missed = [target for target in self._rules.targets if target not in self._reached]
        if missed:
            self._said.note(t, f"{', '.join(missed)} never got parameters")

    def _to_send(self, t: float, target: str, values: dict[str, Value]) -> list[AppliedParameters]:
        """Return what the target's node takes while it runs; others are said once."""
        node = self._rules.nodes.get(target, TARGET_NODES[target])
        table = TABLES[target]
        rows = table.of_distro(self._options.ros_distro if table.differs else None)
        at_once = {name: value for name, value in values.items() if _may_be_told(rows.get(name))}
        file = self._path(find_target(target).file_name)
        if table.no_callback:
            text = f"{target}: {node} gets nothing: {table.no_callback}. Restart it with {file}"
            self._said.begins(t, f"restart {target}", f"{text}; {_OUR_ODOMETRY}")
            return []
        later = [name for name, row in rows.items() if name in values and row.effect == "at a restart"]
        if later:
            text = f"{target}: {', '.join(later)} take effect when {node} is restarted with {file}"
            self._said.begins(t, f"restart {target}", f"{text}; {_OUR_ODOMETRY}")
        if not at_once:
            return []
        self._reached.add(target)
        self._sent |= {(target, name) for name in at_once}
        return [AppliedParameters(t, target, node, dict(at_once), file)]

    def _path(self, name: str) -> str:
        if self._rules.folder is None:
            return f"{name} of `slipwise export`"
        return str(Path(self._rules.folder) / name)

    def _write(self, t: float, name: str, text: str) -> bool:
        if self._rules.folder is None:
            return False
        try:
            write_text_whole(Path(self._rules.folder) / name, text)
        except SlipwiseError as problem:
            self._said.begins(t, f"file {name}", str(problem))
            self._said.count("a file that could not be written")
            return False
        self._said.ends(t, f"file {name}", f"{name} can be written again")
        return True


def _may_be_told(row: RosParameter | None) -> bool:
    return row is not None and row.effect == "at once" and not row.limit

# SPDX-License-Identifier: Apache-2.0
"""Hands an applied model on: files for other tools, and parameters of running nodes."""

from __future__ import annotations

from pathlib import Path

from slipwise.calibration.live_table import TARGET_NODES, ApplyTable
from slipwise.errors import SlipwiseError
from slipwise.export import export_model, find_target
from slipwise.files import write_text_whole
from slipwise.live.outputs import AppliedParameters
from slipwise.live.said import Said
from slipwise.models import Model


class Handover:
    """Writes what is asked for; what cannot be written or does not fit is said once, and the rest goes on."""

    def __init__(self, rules: ApplyTable, said: Said) -> None:
        self._rules, self._said = rules, said

    def hand_on(self, t: float, model: Model) -> list[AppliedParameters]:
        """Write the files; return what running nodes are to be told."""
        self._write(t, "model.yaml", model.to_yaml())
        told = []
        for target in self._rules.targets:
            try:
                made = export_model(model, target, name="the live model")
            except SlipwiseError as problem:
                self._said.begins(t, f"export {target}", f"{target} gets nothing: {problem}")
                continue
            self._said.ends(t, f"export {target}")
            self._write(t, find_target(target).file_name, made.text)
            if self._rules.set_parameters:
                node = self._rules.nodes.get(target, TARGET_NODES[target])
                told.append(AppliedParameters(t, target, node, dict(made.values)))
        return told

    def _write(self, t: float, name: str, text: str) -> None:
        if self._rules.folder is None:
            return
        try:
            write_text_whole(Path(self._rules.folder) / name, text)
        except SlipwiseError as problem:
            self._said.begins(t, f"file {name}", str(problem))
            self._said.count("a file that could not be written")
        else:
            self._said.ends(t, f"file {name}", f"{name} can be written again")

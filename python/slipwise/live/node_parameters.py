# SPDX-License-Identifier: Apache-2.0
"""Sets parameters of running ROS nodes: a target's all or none, after the node has described them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.live.outputs import AppliedParameters
from slipwise.live.parameter_call import DESCRIBE, SET, describe_request, refusals, set_request, why_refused
from slipwise.live.wires.wire import RosWire

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

ANSWER_WITHIN = 2.0  # s


class NodeParameters:
    """Asks nodes, and says what became of it: each thing once, until something else happens to that node.

    Args:
        wire: carries the calls.
        store: of the message types.
    """

    def __init__(self, wire: RosWire, store: Typestore) -> None:
        self._wire, self._store = wire, store
        self._said: dict[str, str] = {}

    def set(self, applied: AppliedParameters) -> str:
        """Set all values of a node, or none; return what is to be said, empty where that was said before."""
        text = f"{applied.target}: {self._outcome(applied)}"
        known, self._said[applied.node] = self._said.get(applied.node), text
        return "" if known == text else text

    def _outcome(self, applied: AppliedParameters) -> str:
        node, values, store = applied.node, applied.values, self._store
        names = ", ".join(values)
        described = self._call(node, "describe_parameters", DESCRIBE, describe_request(list(values), store))
        if described is None:
            return f"{node} does not answer: its parameters are as they were"
        found = refusals(described, values, store)
        if found.others:
            return f"nothing of {node} was set: {'; '.join(found.others)}"
        if found.read_only:
            return (
                f"nothing of {node} was set: {', '.join(found.read_only)} cannot be changed while it runs."
                f" Restart it with {applied.file or 'the exported file'}"
            )
        answer = self._call(node, "set_parameters_atomically", SET, set_request(values, store))
        if answer is None:
            return f"{node} does not answer: whether it took {names} is not known"
        why = why_refused(answer, store)
        return f"{node} refused {names}, nothing was set: {why}" if why else f"{node} took {names}"

    def _call(self, node: str, service: str, kind: str, request: bytes) -> bytes | None:
        return self._wire.call(f"{node}/{service}", kind, request, timeout=ANSWER_WITHIN)

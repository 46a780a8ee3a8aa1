# SPDX-License-Identifier: Apache-2.0
"""What others are given of the model: its text and numbers, and the parameters that are applied."""

from __future__ import annotations

from collections.abc import Callable

from slipwise.live.applied import AppliedModel, without_slip
from slipwise.live.node_parts import NodeParts
from slipwise.live.outputs import ModelText, Output
from slipwise.live.samples import Answer
from slipwise.live.validity import model_words
from slipwise.models import Model


class Giving:
    """Hands on what may be used, and takes it back where poses and inputs contradict each other.

    Args:
        parts: of the node.
        publish: is called with what is given.
    """

    def __init__(self, parts: NodeParts, publish: Callable[[Output], None]) -> None:
        self._parts, self._publish = parts, publish
        self._given: tuple[Model, str] | None = None  # the model that others have, and which it is
        self._handed: Model | None = None  # what files and nodes were given

    def publish_model(self, t: float, *, stuck: bool) -> None:
        """Others get the newest valid model, the last valid one, or the start, whenever it is another.

        Args:
            t: now [s].
            stuck: the robot is, and applied values rest.
        """
        parts = self._parts
        model, which = parts.learning.given()
        if parts.applied is not None:
            valid = None if stuck else parts.learning.valid_now
            if parts.learning.contradicted:
                self._withdraw(t, parts.learning.contradicted)
            parts.applied.step(t, valid, parts.learning.validity.of)
            self._say_held(t, parts.applied)
            if parts.who.apply == "auto" and valid is not None and parts.applied.due(t, valid):
                self._hand_on(t)
        if model is None and self._given is not None:  # it was withdrawn, and there is no start model
            model = self._given[0] if self._given[1] == which else without_slip(self._given[0], which)
        if model is None or (model, which) == self._given:
            return
        self._given = (model, which)
        parts.intake.surfaces.look_again()
        who, validity = parts.who.vehicle, parts.learning.validity.whole
        before = f"# slipwise live, {who}, stamp {t:.3f} s: {which}\n"
        self._publish(ModelText(t, before, model, who, which, validity))

    def _say_held(self, t: float, applied: AppliedModel) -> None:
        said = self._parts.said
        for name in applied.values:
            why = applied.held.get(name)
            if why is None:
                said.ends(t, f"held {name}", f"{name} follows the model again")
            else:
                said.begins(t, f"held {name}", why)

    def _withdraw(self, t: float, why: str) -> None:
        """Take back what was handed on, where something was."""
        parts, handed = self._parts, self._handed
        self._handed = None
        if parts.applied is None or not parts.applied.withdraw() or parts.handover is None or handed is None:
            return
        start = parts.learning.start or without_slip(handed, why)
        for output in parts.handover.withdraw(t, start, why):
            self._publish(output)
        parts.said.note(t, f"applied parameters are withdrawn: {why}")

    def _hand_on(self, t: float) -> None:
        parts = self._parts
        valid = parts.learning.valid
        if parts.applied is None or parts.handover is None or valid is None:
            return
        self._handed = parts.applied.model(valid)
        for output in parts.handover.hand_on(t, self._handed):
            self._publish(output)
        parts.applied.handed_on(t)

    def apply_now(self, t: float) -> Answer:
        """Hand on the newest valid model at once; return what came of it."""
        parts = self._parts
        valid = parts.learning.valid_now
        if parts.applied is None:
            return Answer(False, "no parameters are applied: live.apply.mode is off")
        if valid is None:
            validity = parts.learning.validity
            words = model_words(validity.whole, validity.why)
            return Answer(False, f"no parameters are applied: {words}")
        parts.applied.jump(valid, parts.learning.validity.of)
        self._hand_on(t)
        return Answer(True, "the parameters learned are applied")

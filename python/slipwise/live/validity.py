# SPDX-License-Identifier: Apache-2.0
"""Whether the model, and each parameter of it, may be used: with hysteresis, as the verdict defines it."""

from __future__ import annotations

from slipwise.calibration.judgement import Judgement
from slipwise.live.outputs import Validity
from slipwise.models import Model

CONFIRMED = 3  # judgements in a row that agree before the state changes


#: The states in words.
STATES: dict[Validity, str] = {
    "estimated": "valid",
    "unestimated": "not yet valid",
    "invalid": "not valid",
}


def model_words(state: Validity, why: str) -> str:
    """Return a state of the model with its reason, such as `model valid: misses by 0.1 m ...`."""
    why = why.removeprefix("The model ")
    return f"model {STATES[state]}" + (f": {why[:1].lower()}{why[1:]}" if why else "")


class Hysteresis:
    """A state that changes only where several judgements in a row say so."""

    def __init__(self) -> None:
        self.state: Validity = "unestimated"
        self._wanted: Validity = "unestimated"
        self._agreed = 0

    def take(self, judged: Validity) -> Validity:
        """Take a judgement; return the state."""
        if judged == self.state:
            self._agreed = 0
            return self.state
        self._agreed = self._agreed + 1 if judged == self._wanted else 1
        self._wanted = judged
        if self._agreed >= CONFIRMED:
            self.state, self._agreed = judged, 0
        return self.state

    def set(self, state: Validity) -> None:
        """Change the state at once."""
        self.state, self._agreed = state, 0

    def suspend(self) -> None:
        """Take back what speaks for another state: the terrain changed, and judgements begin again."""
        self._agreed = 0


def judged(model: Model, judgement: Judgement) -> tuple[Validity, str]:
    """Return what one judgement says of the model as a whole, and why, as its verdict has it."""
    verdict = model.content.verdict
    if verdict.good:
        return "estimated", verdict.sentence
    untrue = judgement.consistency is not None and judgement.consistency.untrue
    unknown = judgement.too_short or not (judgement.worse or untrue)
    return ("unestimated" if unknown and not verdict.contradictions else "invalid"), verdict.sentence


class ModelValidity:
    """The validity of a model that is judged again and again."""

    def __init__(self) -> None:
        self._whole = Hysteresis()
        self._parameters: dict[str, Hysteresis] = {}
        self.why = "nothing was learned yet"

    @property
    def whole(self) -> Validity:
        """Of the model as a whole."""
        return self._whole.state

    def take(self, model: Model, judgement: Judgement, waits: str = "") -> None:
        """Take a model with its judgement.

        Args:
            model: what was learned.
            judgement: of its predictions.
            waits: what is missing until a contradiction would have shown itself: nothing is valid before.
        """
        now, self.why = judged(model, judgement)
        if model.content.verdict.contradictions:
            self.contradicted(self.why)
            return
        if waits and now == "estimated":
            now, self.why = "unestimated", f"poses and inputs are compared first: {waits}"
        self._whole.take(now)
        for parameter in model.content.parameters:
            each: Validity = "unestimated"
            if parameter.identifiable and not waits:
                each = "invalid" if now == "invalid" else "estimated"
            self._parameters.setdefault(parameter.name, Hysteresis()).take(each)

    def contradicted(self, why: str) -> None:
        """Poses and inputs contradict each other: nothing is valid, at once."""
        self.why = why
        for each in (self._whole, *self._parameters.values()):
            each.set("invalid")

    def of(self, name: str) -> Validity:
        """Return the validity of a parameter by its name in the model file."""
        found = self._parameters.get(name)
        return "unestimated" if found is None else found.state

    def terrain_changed(self) -> None:
        """Begin to count agreeing judgements again."""
        for each in (self._whole, *self._parameters.values()):
            each.suspend()

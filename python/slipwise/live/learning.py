# SPDX-License-Identifier: Apache-2.0
"""What the learner knows, judged again and again as the verdict does, and what others may have of it."""

from __future__ import annotations

import math
from collections.abc import Callable

from slipwise.calibration.judgement import Judgement
from slipwise.calibration.learner_answers import Event
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.mounts import Mount
from slipwise.errors import SlipwiseError
from slipwise.live.applied import start_value, values_of
from slipwise.live.outputs import Validity
from slipwise.live.said import Said
from slipwise.live.validity import STATES, ModelValidity, model_words
from slipwise.logs.findings.finding import Finding
from slipwise.models import Model

OFTEN, SELDOM = 2.0, 5.0  # s between judgements: a long drive has many predictions to judge
MANY = 100  # segments, from which on judgements are seldom
AGREE_AGAIN = 80  # stretches of 1.5 s of driving without a contradiction end it: two minutes
AFTER_CHANGE = 60.0  # s after a change of terrain in which judgements are frequent all the same


class Learning:
    """The learner with its judgements.

    Args:
        learner: learns from the samples.
        start: the model of before, which others have until something valid is learned.
        valid: the last model that was valid, where a cache has one.
        said: where news are said.
    """

    def __init__(self, learner: MotionLearner, start: Model | None, valid: Model | None, said: Said) -> None:
        self.learner, self.start, self.valid = learner, start, valid
        self.start_values = values_of(start)  # of the parameters by their names
        self.validity = ModelValidity()
        self.model: Model | None = None  # the newest, valid or not
        self.judgement: Judgement | None = None
        self.nis: float | None = None
        self.segments = 0
        self.of_stream: Callable[[], tuple[Finding, ...]] = tuple  # what the learner does not keep
        self.mounts: Callable[[bool], tuple[Mount, ...]] = lambda _: ()  # asked whether nothing more comes
        self._said = said
        self._new = False  # whether something was learned since the last judgement
        self._compared = learner.compared  # how much of the driving was looked at for contradictions by then
        self._judged = -math.inf  # s
        self._changed = -math.inf  # s
        self._shown = False  # whether contradictions would have shown themselves by now
        self._contradicted_at = 0  # the same at the last judgement that found a contradiction
        self.contradicted = ""  # why what was learned must not be used; empty where nothing speaks against it

    def take(self, events: list[Event]) -> bool:
        """Take what the learner had to say; return whether something was learned."""
        learned = False
        for event in events:
            if event.kind == "segment-learned":
                learned = True
                self._new, self.nis, self.segments = True, event.nis, self.segments + 1
            elif event.kind == "terrain-change":
                self._changed = event.t
                self.validity.terrain_changed()
                self._said.note(event.t, "the terrain changed: slip is learned faster for a while")
        return learned

    def judge(self, t: float, *, last: bool = False) -> bool:
        """Judge the model when it is time to, at a stamp [s]; return whether it was.

        Args:
            t: now.
            last: nothing more comes: it is judged whatever the time since the last judgement.
        """
        seldom = self.segments > MANY and t > self._changed + AFTER_CHANGE
        if t < self._judged:  # the clock was set back
            self._judged = -math.inf
        compared = self.learner.compared  # of a localiser that is lost nothing may be learned
        known = bool(self.segments) or self.valid is not None
        new = self._new or (known and compared != self._compared)
        due = new and t >= self._judged + (SELDOM if seldom else OFTEN)
        if not (due or (last and self.segments)):
            return False
        self._new, self._judged, self._compared = False, t, compared
        before = self.validity.whole
        self.learner.know_stream(self.of_stream(), self.mounts(last))
        try:
            self.model, self.judgement = self.learner.judged_model(limits=False)
        except SlipwiseError as problem:
            self._said.begins(t, "no model", str(problem))
            found = [each.sentence for each in self.learner.contradictions() if each.spoils] or [str(problem)]
            self.validity.contradicted("; ".join(found))
        else:
            self._said.ends(t, "no model")
            self._say_findings(t)
            for p in self.model.vector.rows:
                self.start_values.setdefault(p.name, start_value(p))
            waits = "" if self._shown else self.learner.not_shown_yet()
            self._shown = not waits
            found = self.model.content.verdict.contradictions
            self.validity.take(self.model, self.judgement, waits)
        self._follow(t, self._standing("; ".join(found)), before)
        return True

    def _say_findings(self, t: float) -> None:
        """Say once what is wrong and no verdict says."""
        for each in self.learner.found:
            if not each.judged:
                self._said.begins(t, each.kind, " ".join((f"{each.sentence}.", *each.advice)))

    def _standing(self, found: str) -> str:
        """Return why nothing may be used: a contradiction stands until two minutes of driving show none."""
        if found:
            self._contradicted_at = self._compared
        elif self.contradicted and self._compared < self._contradicted_at + AGREE_AGAIN:
            self.validity.contradicted(
                f"poses and inputs contradicted each other lately: {self.contradicted}"
            )
            return self.contradicted
        return found

    def _follow(self, t: float, contradicted: str, before: Validity) -> None:
        """Keep what is valid; what was valid before a contradiction was learned of the same measurements."""
        if contradicted:
            self.valid = None
        if contradicted and not self.contradicted:
            self._said.begins(t, "contradiction", f"the learned model is not used: {contradicted}")
        elif self.contradicted and not contradicted:
            self._said.ends(t, "contradiction", "poses and inputs agree again")
        self.contradicted = contradicted
        if self.model is None:
            return
        if self.validity.whole == "estimated" and self.model.content.verdict.good:
            self.valid = self.model
        if self.validity.whole != before and not contradicted:
            self._said.note(t, model_words(self.validity.whole, self.validity.why))

    @property
    def valid_now(self) -> Model | None:
        """The last valid model while the state is that it may be used; None otherwise."""
        return self.valid if self.validity.whole == "estimated" else None

    def given(self) -> tuple[Model | None, str]:
        """Return the model that others get, and which one that is; None: the kinematic baseline."""
        whole: Validity = self.validity.whole
        if self.valid is not None:
            newest = whole == "estimated" and self.valid is self.model
            return self.valid, "valid" if newest else f"the last valid one; the model is {STATES[whole]} now"
        if self.start is not None:
            return self.start, f"the start model; the learned one is {STATES[whole]}"
        return None, f"none: the learned one is {STATES[whole]}, use the kinematic baseline"

# SPDX-License-Identifier: Apache-2.0
"""Whether a new model predicts a robot better than the one in force, on a log, with intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slipwise.evaluation.evaluate import EvaluationOptions, evaluate
from slipwise.evaluation.head_to_head import HeadToHead, Ratio, head_to_head
from slipwise.evaluation.result import Evaluation
from slipwise.logs.log import Log
from slipwise.models.model import Model
from slipwise.number_text import number_text


@dataclass(frozen=True, eq=False)
class ModelComparison:
    """The errors of a new model relative to an old one's, on all windows of a log."""

    old: str
    new: str
    matches: tuple[HeadToHead, ...]  # one per horizon, the shortest first; the first method is the old model
    learned_from_this: tuple[str, ...]  # models that have learned from the log itself
    evaluation: Evaluation

    @property
    def decisive(self) -> HeadToHead:
        """The longest horizon with enough windows, or the shortest where none has."""
        enough = [match for match in self.matches if not match.too_few]
        return enough[-1] if enough else self.matches[0]

    @property
    def better(self) -> str | None:
        """The model that predicts better beyond chance at that horizon; None where neither does."""
        return self.decisive.better

    def sentences(self) -> tuple[str, ...]:
        """Say which predicts better and by how much, then what is to be known of that."""
        said: tuple[str, ...] = (self._verdict(),)
        if self.learned_from_this:
            favoured = "" if len(self.learned_from_this) == 2 else ", which favours it"
            names = " and ".join(self.learned_from_this)
            was = "were" if len(self.learned_from_this) == 2 else "was"
            said += (f"{names} {was} learned from this log{favoured}: compare on another drive.",)
        spoilt = [each.sentence for each in self.evaluation.contradictions if each.spoils]
        return (*said, f"The log contradicts itself: {'; '.join(spoilt)}.") if spoilt else said

    def _verdict(self) -> str:
        match = self.decisive
        if match.too_few:
            return (
                f"The log is too short to say whether {self.new} predicts better than {self.old}: it has "
                f"{match.windows} segments of {match.horizon:g} s."
            )
        winner = self._winner()
        whose = f"{self.new}'s" if winner.startswith("Neither") else "its"
        parts = [
            f"{whose} {name} error is {_text(ratio)} times that of {self.old}"
            for name, ratio in (("position", match.position), ("heading", match.heading))
            if not math.isnan(ratio[0])
        ]
        figures = f"after {match.horizon:g} s {' and '.join(parts) or 'neither misses'}"
        return f"{winner}: {figures} ({match.windows} segments, 95 % intervals)."

    def _winner(self) -> str:
        match = self.decisive
        if match.better is not None:
            how = "better" if match.better == self.new else "worse"
            return f"{self.new} predicts this robot {how} than {self.old}"
        (_, low, high), (_, heading_low, heading_high) = match.position, match.heading
        for position, heading, apart in (
            ("better", "worse", high < 1.0 < heading_low),
            ("worse", "better", heading_high < 1.0 < low),
        ):
            if apart:
                return f"{self.new} predicts positions {position} and headings {heading} than {self.old}"
        return f"Neither {self.old} nor {self.new} predicts this robot clearly better"


def compare_models(
    old: tuple[str, Model],
    new: tuple[str, Model],
    log: Log,
    *,
    horizons: Sequence[float] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> ModelComparison:
    """Predict a log, or several as one, with two models as they are, and compare their errors.

    Args:
        old: a name for the model in force, and the model.
        new: the same of the one that may take its place.
        log: all its windows count, since models do not learn from it.
        horizons: how far ahead [s]; those of `evaluate` by default.
        progress: called with what is done and the fraction done.

    Raises:
        LogError: the log has no such input, no poses, or no window of any horizon.
        SettingsError: the models were learned from different inputs, or a horizon is wrong.
    """
    models = dict((old, new))
    defaults = EvaluationOptions()
    options = EvaluationOptions(
        horizons=tuple(horizons) if horizons is not None else defaults.horizons,
        methods=("none", *models),
        model=models,
    )
    evaluation = evaluate(log, options=options, progress=progress)
    matches = tuple(
        head_to_head(evaluation, old[0], new[0], horizon=horizon, every=True)
        for horizon in sorted(evaluation.horizons)
    )
    longest = max(evaluation.horizons)
    seen = tuple(name for name in models if not evaluation.score(name, longest).causal)
    return ModelComparison(old[0], new[0], matches, seen, evaluation)


def _text(ratio: Ratio) -> str:
    value, low, high = (number_text(part, 2) for part in ratio)
    return f"{value} ({low} to {high})"

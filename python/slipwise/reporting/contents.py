# SPDX-License-Identifier: Apache-2.0
"""Everything that a report shows, and what several sections ask of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from slipwise.calibration.result import Calibration
from slipwise.evaluation.result import Evaluation, Predictions, Score
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, Log, Run

PLAIN = "none"  # the method that predicts without slip
LEARNED = "auto"  # the method that is slipwise's own
SIMPLE = "edd-2"  # two fitted numbers, today's practice
VENDOR = "vendor"
MAIN_METHODS = (PLAIN, VENDOR, SIMPLE, LEARNED)


@dataclass(frozen=True, eq=False)
class Contents:
    """What a report is about."""

    log: Log
    calibration: Calibration
    evaluation: Evaluation
    title: str
    command: str = ""  # the command line that made the report
    model: Path = Path("model.yaml")  # where the model was written
    kept: dict[str, Any] = field(default_factory=dict, init=False, repr=False)  # what several sections draw

    @property
    def longest_horizon(self) -> float | None:
        """The longest horizon with predictions or scores [s], None where there is none."""
        horizons = [part.horizon for part in self.evaluation.predictions]
        horizons += [score.horizon for score in self.evaluation.scores]
        return max(horizons, default=None)

    @property
    def unknown_after(self) -> float:
        """How old an input may become until it is unknown [s], as it was while learning."""
        window = self.calibration.model.content.provenance.settings.get("segment")
        chosen = window.get("unknown_after") if isinstance(window, dict) else None
        return float(chosen) if chosen is not None else UNKNOWN_AFTER

    @property
    def learned_method(self) -> str | None:
        """The method that was calibrated and judged, else `auto`, else the best causal one."""
        if self.calibration.method in self.evaluation.methods:
            return self.calibration.method
        methods = [name for name in self.evaluation.methods if name not in (PLAIN, VENDOR)]
        if LEARNED in methods:
            return LEARNED
        scores = [
            score
            for score in self.evaluation.scores
            if score.method in methods and score.causal and score.horizon == self.longest_horizon
        ]
        best = min(scores, key=lambda score: score.position.mean, default=None)
        return best.method if best else next(iter(methods), None)

    def score(self, method: str | None, horizon: float | None) -> Score | None:
        """Return the score of a method, None where there is none."""
        found = (s for s in self.evaluation.scores if s.method == method and s.horizon == horizon)
        return next(found, None)

    def predictions(self, method: str | None, horizon: float | None) -> Predictions | None:
        """Return the predictions of a method, None where there are none at all."""
        for part in self.evaluation.predictions:
            if part.method == method and part.horizon == horizon and len(part.t_start):
                return part
        return None

    def inputs(self, run: Run) -> Inputs | None:
        """Return the inputs of a run that were evaluated: commands, or the twist from the wheels."""
        inputs = run.wheels if self.evaluation.input == "wheel" else run.commands
        return inputs if inputs is not None and len(inputs) else None


class Section(Protocol):
    """One heading of the report with what stands below it.

    A section shows nothing it does not have: where data are missing, its html is a sentence that says so
    (`markup.missing`). Text that came from a user goes through `markup.escape`; pictures are a `Figure`.
    """

    title: str  # says what one sees
    explanation: str  # one plain sentence, below the title

    def html(self, contents: Contents) -> str:
        """Return the HTML below title and explanation."""
        ...

# SPDX-License-Identifier: Apache-2.0
"""The verdict on an evaluation: the learned method against the baseline, and simpler ones against it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.calibration import Calibration, Verdict
    from slipwise.calibration.verdict import Identified
    from slipwise.evaluation import Evaluation
    from slipwise.models import Model

#: What learns nothing, or nothing causally, and baselines that no model file can hold.
_NOT_JUDGED = ("none", "vendor", "batch", "slip-ratio-ekf", "slip-ratio-smo", "neural", "neural-residual")

LEARNED_FROM_THIS = "The model was learned from this very log: judge it on another drive."


def judged_method(methods: tuple[str, ...], models: tuple[str, ...] = ()) -> str | None:
    """Return the method judged: the first model file, else `auto`, else the first that learns; or None."""
    names = [name for name in methods if name not in _NOT_JUDGED]
    return next((name for name in (*models, "model", "auto") if name in names), names[0] if names else None)


def verdict_on(evaluation: Evaluation, source: Calibration | Model | None) -> Verdict | None:
    """Judge the learned method against `none` at the longest horizon; None where no method learns.

    Args:
        evaluation: with `none` among its methods.
        source: what says which parameters are not identifiable: the calibration, or the model judged.
    """
    from slipwise.calibration.judge import ToJudge, judge
    from slipwise.calibration.verdict import LogFacts

    method = judged_method(evaluation.methods, evaluation.models)
    if method is None or source is None:
        return None
    longest = {p.method: p for p in evaluation.predictions if p.horizon == max(evaluation.horizons)}
    compared = evaluation.clocks_compared
    facts = LogFacts(evaluation.contradictions, _SHORTAGE, evaluation.input, evaluation.positions, compared)
    horizons = tuple(p for p in evaluation.predictions if p.method == method)
    learned = ToJudge(longest[method], longest["none"], _identified(source), (), horizons)
    verdict = judge(learned, facts).verdict
    return replace(verdict, advice=tuple(dict.fromkeys((*verdict.advice, *_more_advice(evaluation, method)))))


_SHORTAGE = ("Evaluate on a longer drive, or with shorter --horizons: these segments are too few.",)


def _identified(source: Calibration | Model) -> Identified:
    from slipwise.calibration import Calibration
    from slipwise.calibration.identifiability import longest_delay
    from slipwise.calibration.verdict import Identified

    calibrated = isinstance(source, Calibration)
    model = source.model if isinstance(source, Calibration) else source
    content, vector = model.content, model.vector
    return Identified(
        len(vector.rows),
        tuple(content.verdict.not_identifiable),
        tuple(content.verdict.advice),
        timing=content.verdict.timing,
        force=content.verdict.force,
        delay=longest_delay(vector.names, vector.values.tolist()),
        from_log="this log" if calibrated else "the log of the model",
    )


def _more_advice(evaluation: Evaluation, method: str) -> tuple[str, ...]:
    from slipwise.evaluation import simpler_method

    contradicted = any(each.spoils for each in evaluation.contradictions)
    simpler = None if contradicted else simpler_method(evaluation, method)
    advice = () if simpler is None else (simpler.advice(),)
    if not evaluation.score(method, max(evaluation.horizons)).causal:
        advice = (*advice, LEARNED_FROM_THIS)
    return advice
